// @ts-check
/** What the server's check says of a study: what it costs, derived values, warnings, stray errors. */
import { h, show } from "../dom.js";
import { bytes, number, quantity, roughly } from "../format.js";
import { nameOf } from "../schema.js";
import { titleOf, words } from "../titles.js";
import { sentence } from "./finding-lines.js";

/** @typedef {import("../types.js").Report} Report */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../types.js").Estimate} Estimate */

/** Derived values that the cost says already. */
const SAID = ["unknowns", "steps"];

export class StudyReport extends HTMLElement {
  /**
   * @param {Report | null} report
   * @param {{ errors: Finding[] }} elsewhere those that no input shows
   */
  update(report, { errors }) {
    const { estimate = null, warnings = [] } = report ?? {};
    const derived = Object.entries(report?.derived ?? {}).filter(([name]) => !(estimate && SAID.includes(name)));
    this.hidden = !report?.estimate && !errors.length;
    show(
      this,
      errors.map(({ pointer, ...finding }) =>
        h("div", { class: "notice bad", role: "alert" }, h("div", null, h("p", null, sentence({ pointer, ...finding })), pointer && h("p", { class: "mono" }, pointer))),
      ),
      estimate && cost(estimate),
      warnings.map((finding) => h("div", { class: "notice wait" }, h("p", null, h("strong", null, subject(finding)), ": ", sentence(finding)))),
      derived.length > 0 &&
        h("section", { class: "derived" }, h("h3", null, "What follows"), h("dl", null, derived.map(([name, item]) => row(item.title || words(name), item)))),
    );
  }
}

/** @param {Estimate} estimate */
function cost(estimate) {
  const runs = estimate.runs ?? 1;
  return [
    h(
      "dl",
      { class: "cost" },
      fact(runs > 1 ? `Time, ${number(runs)} runs` : "Time", roughly(estimate.seconds)),
      fact("Memory", bytes(estimate.memory_bytes)),
      fact("Disk", bytes(estimate.disk_bytes)),
      fact("Unknowns", number(estimate.unknowns, 4)),
      (estimate.steps ?? 0) > 1 && fact(runs > 1 ? "Steps, all runs" : "Steps", number(estimate.steps, 6)),
    ),
    estimate.basis && h("p", { class: "soft small" }, `Basis: ${estimate.basis}.`),
  ];
}

/**
 * What a warning speaks of: its field, and the value where it is short.
 *
 * @param {Finding} finding
 */
function subject({ pointer, value }) {
  const own = pointer.replace(/^\/study(?=\/|$)/, "").replace(/(\/\d+)+$/, "");
  const shown = typeof value === "string" && value.length < 24 ? ` ${words(value).toLowerCase()}` : "";
  return `${titleOf(own, own ? nameOf(own) : "Study")}${shown}`;
}

/**
 * @param {string} title
 * @param {import("../types.js").Quantity} item
 */
function row(title, item) {
  return fact(title, text(item));
}

/**
 * @param {import("../types.js").Quantity} item
 * @returns {string}
 */
function text(item) {
  if (Array.isArray(item.value)) return item.value.map((part) => text({ ...item, value: part })).join(", ");
  return typeof item.value === "number" ? quantity(item.value, item.unit, 4) : String(item.value);
}

/**
 * @param {string} term
 * @param {string} words
 */
function fact(term, words) {
  return h("div", null, h("dt", null, term), h("dd", null, words));
}

customElements.define("tb-study-report", StudyReport);
