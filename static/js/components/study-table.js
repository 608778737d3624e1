// @ts-check
/**
 * A list of things as a table of inputs: axles, vehicle types, points of a profile. A block of cells
 * from a spreadsheet can be pasted at any of them. Emits `edit` with the changed list.
 */
import { h, show } from "../dom.js";
import { entered, shown } from "../entry.js";
import { unitText } from "../format.js";
import { asTabs, cellsOf, isTable } from "../paste.js";
import { at, keyed, withValue } from "../pointer.js";
import { isTransposed, pasted, rowName } from "../table-edit.js";
import { words } from "../titles.js";
import { findingLines, wasLine } from "./finding-lines.js";
import { unfold } from "./study-focus.js";

/** @typedef {import("../form-plan.js").TableNode} TableNode */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {{ row: number, column: number }} Cell of the study's list */

export class StudyTable extends HTMLElement {
  /** @type {TableNode | null} */
  #node = null;
  /** @type {any[]} */
  #rows = [];
  /** @type {Map<string, string>} what is typed and is no value, by pointer of the cell */
  #wrong = new Map();
  #message = h("div", { class: "field-message", role: "status" });
  #was = h("p", { class: "was", hidden: true });
  #table = h("table", null);

  /**
   * @param {TableNode} node
   * @param {any[]} rows
   */
  bind(node, rows) {
    this.#node = node;
    this.#rows = rows;
    this.dataset.pointer = node.pointer;
    show(
      this,
      h("div", { class: "row spread" }, h("h4", null, node.title), h("div", { class: "row" }, this.#buttons(node))),
      h("p", { class: "field-help" }, node.help, " Paste cells from a spreadsheet at any of them."),
      h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": node.title }, this.#table),
      this.#message,
      this.#was,
    );
    this.#draw(node);
  }

  /** @param {Finding[]} errors @param {Finding[]} warnings */
  place(errors, warnings) {
    const own = [...this.#wrong].map(([pointer, reason]) => ({ pointer, reason }));
    for (const input of this.querySelectorAll("[data-cell]")) {
      const pointer = input.getAttribute("data-cell") ?? "";
      const bad = [...own, ...errors].some((finding) => finding.pointer.endsWith(pointer));
      input.setAttribute("aria-invalid", String(bad));
    }
    const said = [...own, ...errors].map((finding) => ({ ...finding, reason: `${this.#place(finding.pointer)}${finding.reason}` }));
    this.classList.toggle("invalid", said.length > 0);
    show(this.#message, findingLines(said, warnings, () => null));
  }

  /** @param {any} before @param {boolean} changed */
  mark(before, changed) {
    this.classList.toggle("changed", changed);
    this.#was.hidden = !changed;
    for (const input of this.querySelectorAll("[data-cell]")) {
      const inner = (input.getAttribute("data-cell") ?? "").slice(this.dataset.pointer?.length);
      const now = at(this.#rows, inner);
      input.classList.toggle("changed-cell", changed && JSON.stringify(at(before, inner)) !== JSON.stringify(now));
    }
    if (changed) show(this.#was, wasLine(before?.length === this.#rows.length ? "" : `${before?.length ?? 0} rows`, this.name, () => this.#send(before, true)));
  }

  get name() {
    return this.#node?.title ?? "";
  }

  get broken() {
    return this.#wrong.size > 0;
  }

  focus() {
    unfold(this);
    /** @type {HTMLElement | null} */ (this.querySelector('[aria-invalid="true"]') ?? this.querySelector("[data-cell]"))?.focus();
  }

  /** @param {TableNode} node */
  #buttons(node) {
    const add = () => this.#send([...this.#rows, structuredClone(this.#rows.at(-1) ?? node.blank)], true);
    const remove = () => this.#send(this.#rows.slice(0, -1), true);
    const copy = () => void navigator.clipboard?.writeText(asTabs(this.#lines(node))).catch(() => {}); // refused: nothing is copied
    return [
      h("button", { type: "button", class: "small-button", onclick: copy, "aria-label": `Copy ${node.title} for a spreadsheet` }, "Copy table"),
      h("button", { type: "button", class: "small-button", onclick: remove, disabled: node.count <= node.least, "aria-label": `Remove the last of ${node.title}` }, "Remove last"),
      h("button", { type: "button", class: "small-button", onclick: add, disabled: node.count >= node.most, "aria-label": `Add to ${node.title}` }, "Add"),
    ];
  }

  /** @param {TableNode} node @returns {string[][]} as on the screen, without headings */
  #lines(node) {
    const lines = this.#rows.map((row) => node.columns.map((column) => shown(at(row, column.pointer), column)));
    return isTransposed(node.columns) ? node.columns.map((_, index) => lines.map((line) => line[index])) : lines;
  }

  /** @param {TableNode} node */
  #draw(node) {
    const { columns } = node;
    /** @param {import("../schema.js").Field} column */
    const unit = (column) => h("span", { class: "unit" }, unitText(column.unit));
    if (isTransposed(columns)) {
      const head = h("tr", null, h("td", null), this.#rows.map((row, index) => h("th", { scope: "col" }, words(rowName(row, index)))), h("td", null));
      const body = columns.map((column, index) =>
        h("tr", null, h("th", { scope: "row", title: column.help }, column.label), this.#rows.map((_, row) => h("td", null, this.#input(node, { row, column: index }))), h("td", { class: "unit-cell" }, unit(column))));
      show(this.#table, h("thead", null, head), h("tbody", null, body)); // prettier-ignore
      return;
    }
    const head = h("tr", null, h("td", null), columns.map((column) => h("th", { scope: "col", title: column.help }, column.label, " ", unit(column))));
    const body = this.#rows.map((_, row) => h("tr", null, h("th", { scope: "row" }, String(row + 1)), columns.map((_, column) => h("td", null, this.#input(node, { row, column })))));
    show(this.#table, h("thead", null, head), h("tbody", null, body));
  }

  /** @param {TableNode} node @param {Cell} cell */
  #input(node, cell) {
    const column = node.columns[cell.column];
    const row = this.#rows[cell.row];
    const common = {
      "data-cell": keyed(node.pointer, cell.row) + column.pointer,
      "aria-label": `${column.label}, ${rowName(row, cell.row)}${column.unit ? ` [${unitText(column.unit)}]` : ""}`,
    };
    const value = at(row, column.pointer);
    if (column.kind === "choice") {
      return h("select", { ...common, onchange: (/** @type {any} */ event) => this.#typed(event.target, cell) }, column.options.map((option) => h("option", { value: option, selected: option === value }, words(option))));
    }
    return h("input", {
      ...common,
      type: "text",
      autocomplete: "off",
      spellcheck: "false",
      class: column.kind === "text" ? "word" : "figure",
      value: shown(value, column),
      oninput: (/** @type {any} */ event) => this.#typed(event.target, cell),
      onpaste: (/** @type {ClipboardEvent} */ event) => this.#paste(event, cell),
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.#move(event),
    });
  }

  /** @param {HTMLInputElement | HTMLSelectElement} input @param {Cell} cell */
  #typed(input, cell) {
    const column = /** @type {TableNode} */ (this.#node).columns[cell.column];
    const pointer = input.dataset.cell ?? "";
    const entry = entered(input.value, column);
    if (entry.error !== undefined) this.#wrong.set(pointer, entry.error);
    else this.#wrong.delete(pointer);
    this.place([], []);
    if (entry.error === undefined) this.#rows = this.#rows.with(cell.row, withValue(this.#rows[cell.row], column.pointer, entry.value));
    this.#send(this.broken ? undefined : this.#rows, false);
  }

  /** @param {ClipboardEvent} event @param {Cell} cell */
  #paste(event, cell) {
    const text = event.clipboardData?.getData("text/plain") ?? "";
    const node = this.#node;
    if (!node || !isTable(text)) return;
    event.preventDefault();
    const { rows, refused } = pasted(this.#rows, node.columns, cellsOf(text), cell, node);
    if (refused.length) this.dispatchEvent(new CustomEvent("refused", { detail: { refused }, bubbles: true }));
    this.#send(rows, true); // last: every table is drawn anew, this one is gone then
  }

  /** Up and down as in a spreadsheet. @param {KeyboardEvent} event */
  #move(event) {
    const way = { ArrowDown: 1, Enter: 1, ArrowUp: -1 }[event.key];
    if (!way) return;
    const cell = /** @type {HTMLElement} */ (event.target).closest("td");
    const line = [.../** @type {HTMLTableElement} */ (this.#table).rows];
    const next = line[line.indexOf(/** @type {any} */ (cell?.parentElement)) + way];
    const index = [...(cell?.parentElement?.children ?? [])].indexOf(/** @type {any} */ (cell));
    const input = /** @type {HTMLElement | null} */ (next?.children[index]?.querySelector("[data-cell]"));
    if (input) event.preventDefault();
    input?.focus();
  }

  /** Which cell a finding is about, in words. @param {string} pointer */
  #place(pointer) {
    const node = this.#node;
    const inner = pointer.slice(pointer.indexOf(node?.pointer ?? "") + (node?.pointer.length ?? 0));
    const [, row = ""] = inner.split("/");
    const column = node?.columns.find((item) => inner === `/${row}${item.pointer}`);
    return column ? `${column.label}, ${rowName(this.#rows[Number(row)], Number(row))}: ` : "";
  }

  /** @param {any} value @param {boolean} whole */
  #send(value, whole) {
    this.dispatchEvent(new CustomEvent("edit", { detail: { pointer: this.#node?.pointer, value, whole }, bubbles: true }));
  }
}

customElements.define("tb-table", StudyTable);
