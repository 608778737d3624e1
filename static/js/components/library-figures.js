// @ts-check
/** Every figure of a part with its unit; those that cannot be trusted far are marked and explained. */
import { h, show } from "../dom.js";
import { kindOf, studyAround } from "../library-parts.js";
import { studySections } from "../study-rows.js";

/** @typedef {import("../types.js").LibraryItem} Item */
/** @typedef {import("../types.js").Remark} Remark */
/** @typedef {import("../study-rows.js").Row} Row */

export class LibraryFigures extends HTMLElement {
  /**
   * @param {Item} item
   * @param {import("../types.js").Template[]} templates
   * @param {any} document the OpenAPI document
   */
  bind(item, templates, document) {
    const part = kindOf(item.kind)?.part ?? "";
    const study = studyAround(part, item.value, templates);
    const groups = studySections(study, "crossing", null, document)
      .flatMap((section) => section.groups)
      .map(({ title, rows }) => ({ title, rows: rows.filter(({ pointer }) => pointer.startsWith(`/${part}/`)) }))
      .filter(({ rows }) => rows.length);
    const remarks = new Map(item.remarks.map((remark) => [`/${part}${remark.pointer}`, remark]));
    show(
      this,
      remarks.size > 0 && h("p", { class: "notice wait" }, `${remarks.size} figure${remarks.size > 1 ? "s are" : " is"} of low confidence or a reading; marked below.`),
      h("div", { class: "figure-groups" }, groups.map((group) => h("section", null, h("h3", null, group.title), h("dl", null, group.rows.map((row) => line(row, remarks.get(row.pointer))))))),
    );
  }
}

/**
 * @param {Row} row
 * @param {Remark | undefined} remark
 */
function line(row, remark) {
  return h(
    "div",
    { class: remark ? "doubtful" : null },
    h("dt", null, row.label),
    h("dd", null, `${row.text} ${row.unit}`.trim()),
    remark && h("dd", { class: "remark" }, h("span", { class: "tag queued" }, confidence(remark)), " ", remark.text),
  );
}

/** @param {Remark} remark */
function confidence(remark) {
  return remark.confidence.length === 1 ? `confidence ${remark.confidence}` : remark.confidence;
}

customElements.define("tb-library-figures", LibraryFigures);
