// @ts-check
/** The lines under an input: what is wrong, what is doubtful, what it was. */
import { h } from "../dom.js";

/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {(finding: Finding) => { text: string, use: () => void } | null} Advice */

/**
 * @param {Finding[]} errors
 * @param {Finding[]} warnings
 * @param {Advice} advice a value that one click takes over
 */
export function findingLines(errors, warnings, advice) {
  /** @param {string} kind @returns {(finding: Finding) => HTMLElement} */
  const line = (kind) => (finding) => {
    const found = advice(finding);
    return h(
      "p",
      { class: `field-${kind}` },
      h("span", { class: "sr" }, kind === "error" ? "Error: " : "Warning: "),
      sentence(finding),
      found && [" ", h("button", { type: "button", class: "link", onclick: found.use }, `Use ${found.text}`)],
    );
  };
  return [...errors.map(line("error")), ...warnings.map(line("warning"))];
}

/**
 * @param {string} before what it was, as text; empty where that says nothing
 * @param {string} name of the input
 * @param {() => void} reset
 */
export function wasLine(before, name, reset) {
  return [
    h("span", { class: "dot", "aria-hidden": "true" }),
    h("span", null, before.trim() ? ["Changed, was ", h("span", { class: "before" }, before)] : "Changed"),
    h("button", { type: "button", class: "link", onclick: reset, "aria-label": `Reset ${name}` }, "Reset this field"),
  ];
}

/**
 * A finding in one or two sentences.
 *
 * @param {Finding} finding
 */
export function sentence(finding) {
  return [finding.reason, finding.remedy]
    .filter(Boolean)
    .map((text) => String(text).trim())
    .map((text) => text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : "."))
    .join(" ");
}
