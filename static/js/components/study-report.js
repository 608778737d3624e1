// @ts-check
/** What the server's check says of a study: estimate, derived values, warnings, other errors. */
import { h, show } from "../dom.js";
import { bytes, label, number, quantity, roughly } from "../format.js";
import { sentence } from "./field.js";

/** @typedef {import("../types.js").Report} Report */
/** @typedef {import("../types.js").Finding} Finding */

export class StudyReport extends HTMLElement {
  /**
   * @param {Report | null} report
   * @param {Finding[]} elsewhere errors that no field of the form shows
   */
  update(report, elsewhere) {
    const estimate = report?.estimate;
    show(
      this,
      elsewhere.map((finding) =>
        h("div", { class: "notice bad", role: "alert" }, h("div", null, h("p", null, sentence(finding)), finding.pointer && h("p", { class: "mono" }, finding.pointer))),
      ),
      (report?.warnings ?? []).map((finding) =>
        h("div", { class: "notice wait" }, h("p", null, sentence({ ...finding, reason: `${subject(finding)} ${finding.reason}` }))),
      ),
      estimate &&
        h(
          "dl",
          { class: "facts" },
          fact("Time", roughly(estimate.seconds)),
          fact("Steps", number(estimate.steps, 4)),
          fact("Unknowns", number(estimate.unknowns, 3)),
          fact("Memory", bytes(estimate.memory_bytes)),
          fact("Disk", bytes(estimate.disk_bytes)),
          (estimate.runs ?? 1) > 1 && fact("Runs", number(estimate.runs)),
        ),
      derived(report),
    );
  }
}

/**
 * What a finding speaks of: its field and value.
 *
 * @param {Finding} finding
 */
function subject({ pointer, value }) {
  const name = pointer.split("/").filter((part) => part && !/^\d+$/.test(part)).pop() ?? "study";
  const shown = typeof value === "string" || typeof value === "number" ? ` ${value}` : "";
  return `${label(name)}${shown}`;
}

/** @param {Report | null} report */
function derived(report) {
  const rows = Object.entries(report?.derived ?? {});
  if (!rows.length) return null;
  return h(
    "details",
    { class: "derived" },
    h("summary", null, "Derived values"),
    h(
      "dl",
      null,
      rows.map(([name, item]) => fact(item.title || label(name), value(item))),
    ),
  );
}

/**
 * @param {import("../types.js").Quantity} item
 * @returns {string}
 */
function value(item) {
  if (Array.isArray(item.value)) return item.value.map((part) => value({ ...item, value: part })).join(", ");
  return typeof item.value === "number" ? quantity(item.value, item.unit, 4) : String(item.value);
}

/**
 * @param {string} term
 * @param {string} text
 */
function fact(term, text) {
  return h("div", null, h("dt", null, term), h("dd", null, text));
}

customElements.define("tb-study-report", StudyReport);
