// @ts-check
/** What was computed and with what: model, mesh notes, times, versions. */
import { h, show } from "../dom.js";
import { bytes, duration, label, number } from "../format.js";

/** @typedef {import("../types.js").Run} Run */

/** Facts that only the page itself needs. */
const SILENT = new Set(["live_channels", "mesh_accuracy", "acceleration_limit"]);

/** @type {Record<string, [number, string]>} */
const UNITS = {
  member_frequencies: [1, "Hz"],
  static_wheel_load: [1e-3, "kN"],
  approach_bed_stiffness: [1e-6, "MN/m"],
};

export class RunFacts extends HTMLElement {
  /** @param {Run} run */
  set run(run) {
    const summary = run.summary ?? {};
    this.classList.add("card", "run-facts");
    const facts = Object.entries(summary.facts ?? {}).filter(([name]) => !SILENT.has(name));
    show(
      this,
      h("h2", null, "How it was computed"),
      accuracy(summary.facts),
      h(
        "div",
        { class: "fact-columns" },
        group("Model", facts.map(([name, value]) => [label(name), inUnit(name, value)])),
        group("Time and memory", times(summary.timings ?? {})),
        group("Versions", Object.entries(summary.versions ?? {})),
      ),
    );
  }
}

/** @param {Record<string, any> | undefined} facts */
function accuracy(facts) {
  const notes = facts?.mesh_accuracy;
  if (!Array.isArray(notes) || !notes.length) return null;
  return h("div", { class: "notice wait" }, h("div", null, notes.map((note) => h("p", null, String(note)))));
}

/** @param {Record<string, number>} timings */
function times(timings) {
  return Object.entries(timings).map(([name, value]) => {
    if (name === "memory") return ["Peak memory", bytes(value)];
    if (name === "per step") return ["Each step", `${number(value * 1e3, 3)} ms`];
    return [label(name), duration(value)];
  });
}

/**
 * A fact with its unit; facts come as plain SI values.
 *
 * @param {string} name
 * @param {any} value
 */
function inUnit(name, value) {
  const [scale, symbol] = UNITS[name] ?? [1, ""];
  const scaled = typeof value === "number" ? value * scale : value;
  return `${text(scaled)} ${symbol}`.trim();
}

/**
 * @param {any} value
 * @returns {string}
 */
function text(value) {
  if (Array.isArray(value)) return value.map(text).join(", ");
  if (typeof value === "number") return number(value, 4);
  if (value && typeof value === "object") {
    return Object.entries(value).map(([name, part]) => `${label(name)}: ${text(part)}`).join("; ");
  }
  return String(value);
}

/**
 * @param {string} title
 * @param {string[][]} rows
 */
function group(title, rows) {
  if (!rows.length) return null;
  return h(
    "section",
    null,
    h("h3", null, title),
    h("dl", null, rows.map(([term, value]) => h("div", null, h("dt", null, term), h("dd", null, value)))),
  );
}

customElements.define("tb-run-facts", RunFacts);
