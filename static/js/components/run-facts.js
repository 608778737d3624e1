// @ts-check
/** What was computed and with what: model, what is assumed, accuracy, times, versions. */
import { h, show } from "../dom.js";
import { bytes, duration, label, number } from "../format.js";

/** @typedef {import("../types.js").Run} Run */

/** Facts that only the page itself needs, or that stand in a paragraph of their own. */
const SILENT = new Set(["live_channels", "mesh_accuracy", "acceleration_limit", "assumed", "assumption"]);

/** Titles, and where the plain SI value needs one, scale and unit. @type {Record<string, [string, number?, string?]>} */
const FACTS = {
  unknowns_structure: ["Unknowns of viaduct and track"],
  unknowns_rails: ["Unknowns of rails and approaches"],
  unknowns_train: ["Unknowns of the train"],
  static_wheel_load: ["Mean static wheel load", 1e-3, "kN"],
  back_end: ["Sparse solver"],
  approach_bed_stiffness: ["Bed stiffness under a sleeper, one rail's share", 1e-6, "MN/m"],
  member_frequencies: ["First frequencies of the judged span", 1, "Hz"],
};

/** @type {Record<string, string>} */
const VERSIONS = { python: "Python", machine: "Processor", numpy: "NumPy", scipy: "SciPy", zarr: "Zarr", mkl: "MKL", trainbridge: "Trainbridge" };

export class RunFacts extends HTMLElement {
  /** @param {Run} run */
  set run(run) {
    const summary = run.summary ?? {};
    this.classList.add("card", "run-facts");
    const plainBeam = summary.facts?.unknowns_structure === 0;
    const facts = Object.entries(summary.facts ?? {}).filter(
      ([name]) => !SILENT.has(name) && !(plainBeam && name === "unknowns_structure"),
    );
    show(
      this,
      h("h2", null, "How it was computed"),
      remarks(summary.facts ?? {}),
      h(
        "div",
        { class: "fact-columns" },
        group("Model", facts.map(([name, value]) => [title(name, plainBeam), inUnit(name, value)])),
        group("Time and memory", times(summary.timings ?? {})),
        group("Versions", Object.entries(summary.versions ?? {}).map(([name, text]) => [VERSIONS[name] ?? name, text])),
      ),
    );
  }
}

/**
 * @param {string} name
 * @param {boolean} plainBeam the wheels roll on the beam itself
 */
function title(name, plainBeam) {
  if (plainBeam && name === "unknowns_rails") return "Unknowns of the beam";
  return FACTS[name]?.[0] ?? label(name);
}

/**
 * What an engineer must know before using the numbers.
 *
 * @param {Record<string, any>} facts
 */
function remarks(facts) {
  const accuracy = lines(facts.mesh_accuracy);
  const assumed = lines(facts.assumed);
  const notes = [
    accuracy.length > 0 && h("div", null, h("dt", null, "Accuracy of this mesh"), accuracy.map((line) => h("dd", null, line))),
    assumed.length > 0 && h("div", null, h("dt", null, "Assumed, because the sources do not print it"), h("dd", null, `${sentence(assumed.join("; "))}.`)),
    lines(facts.assumption).map((line) => h("div", null, h("dt", null, "Note"), h("dd", null, `${sentence(line)}.`))),
  ];
  return notes.some((note) => (Array.isArray(note) ? note.length : note)) && h("dl", { class: "remarks" }, notes);
}

/** @param {any} value a sentence, several, or nothing */
const lines = (value) => (value === undefined || value === null ? [] : [value].flat().map(String));

/** @param {string} text */
const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

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
  const [, scale = 1, symbol = ""] = FACTS[name] ?? [];
  const scaled = typeof value === "number" ? value * scale : value;
  return `${text(scaled)} ${symbol}`.trim();
}

/**
 * @param {any} value
 * @returns {string}
 */
function text(value) {
  if (Array.isArray(value)) return value.map(text).join(", ");
  if (typeof value === "number") return Number.isInteger(value) ? number(value, 12) : number(value, 4);
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
