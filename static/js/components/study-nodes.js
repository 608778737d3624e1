// @ts-check
/** The elements of a form's plan: inputs, choices, tables and headings between them. */
import { h } from "../dom.js";
import { at } from "../pointer.js";
import { titleOf } from "../titles.js";
import { FieldInput } from "./field.js";
import { StudyChoice } from "./study-choice.js";
import { StudyTable } from "./study-table.js";

/** @typedef {import("../form-plan.js").Node} Node */
/** @typedef {import("../types.js").Study} Study */
/** An element that takes findings and marks of one pointer. @typedef {FieldInput | StudyChoice | StudyTable} Place */

/**
 * @param {Node[]} nodes
 * @param {Study} study
 * @param {number} [depth]
 * @returns {HTMLElement[]}
 */
export function nodeElements(nodes, study, depth = 3) {
  return nodes.flatMap((node) => elementsOf(node, study, depth));
}

/**
 * @param {Node} node
 * @param {Study} study
 * @param {number} depth
 * @returns {HTMLElement[]}
 */
function elementsOf(node, study, depth) {
  if (node.type === "field") {
    const input = /** @type {FieldInput} */ (h("tb-field"));
    input.bind(node.field, at(study, node.pointer));
    return [input];
  }
  if (node.type === "table") {
    const table = /** @type {StudyTable} */ (h("tb-table"));
    table.bind(node, at(study, node.pointer) ?? []);
    return [table];
  }
  if (node.type === "choice") {
    const choice = /** @type {StudyChoice} */ (h("tb-choice"));
    choice.bind(node);
    return [choice, ...nodeElements(node.children, study, depth)];
  }
  const title = h(`h${Math.min(depth, 6)}`, null, titleOf(node.pointer, node.title));
  const about = node.help && h("p", { class: "field-help" }, node.help);
  const inner = node.type === "items" ? items(node, study, depth) : nodeElements(node.children, study, depth + 1);
  return [h("div", { class: "group" }, title, about, inner)];
}

/**
 * Things of several kinds in a row; each can be taken out.
 *
 * @param {import("../form-plan.js").ItemsNode} node
 * @param {Study} study
 * @param {number} depth
 */
function items(node, study, depth) {
  const rows = at(study, node.pointer) ?? [];
  /** @param {any[]} value @returns {(event: Event) => boolean} */
  const send = (value) => (event) =>
    /** @type {Element} */ (event.target).dispatchEvent(new CustomEvent("edit", { detail: { pointer: node.pointer, value, whole: true }, bubbles: true }));
  return [
    node.children.map((child, index) =>
      h("div", { class: "group item" },
        nodeElements([child], study, depth + 1),
        h("button", { type: "button", class: "small-button", onclick: send(rows.toSpliced(index, 1)), "aria-label": `Remove ${node.title} ${index + 1}` }, "Remove"))),
    rows.length < node.most && h("button", { type: "button", class: "small-button", onclick: send([...rows, structuredClone(node.blank)]) }, `Add to ${node.title.toLowerCase()}`),
  ]; // prettier-ignore
}
