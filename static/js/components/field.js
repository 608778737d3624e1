// @ts-check
/**
 * One input with its unit, bounds, help, errors and warnings, and a mark where it differs from the
 * template. Emits `edit` {pointer, value, whole}; value is undefined while the text is none.
 */
import { h, show } from "../dom.js";
import { entered, range, shown } from "../entry.js";
import { unitText } from "../format.js";
import { isTable, listOf } from "../paste.js";
import { advised } from "../remedy.js";
import { helpOf, titleOf } from "../titles.js";
import { findingLines, wasLine } from "./finding-lines.js";
import { unfold } from "./study-focus.js";

/** @typedef {import("../schema.js").Field} Field */
/** @typedef {import("../types.js").Finding} Finding */

export class FieldInput extends HTMLElement {
  /** @type {Field | null} */
  #field = null;
  #ownError = "";
  /** @type {Finding[]} */
  #errors = [];
  /** @type {Finding[]} */
  #warnings = [];
  #message = h("div", { class: "field-message" });
  #was = h("p", { class: "was" });
  /** @type {HTMLInputElement | HTMLSelectElement | null} */
  #control = null;

  /**
   * Shows a field and its value.
   *
   * @param {Field} field
   * @param {any} value SI
   */
  bind(field, value) {
    this.#field = field;
    const id = `field${field.pointer.replace(/[^\w]/g, "-")}`;
    this.#control = control(field, value, id);
    this.#control.addEventListener(field.kind === "choice" || field.kind === "switch" ? "change" : "input", () => this.#edit());
    this.#control.addEventListener("paste", (event) => this.#paste(/** @type {ClipboardEvent} */ (event)));
    this.#message.id = `${id}-error`;
    const limits = range(field);
    this.dataset.pointer = field.pointer;
    this.classList.toggle("long", field.kind === "list" || field.kind === "texts");
    this.classList.toggle("words", field.kind === "text");
    show(
      this,
      h("label", { for: id }, this.name),
      h("div", { class: "field-control" }, this.#control, h("span", { class: "unit" }, unitText(field.unit))),
      h(
        "p",
        { class: "field-help", id: `${id}-help` },
        helpOf(field.pointer, field.help).replace(/ = /g, "\u00a0=\u00a0"),
        limits && [" ", h("span", { class: "limits" }, limits)],
      ),
      this.#message,
      this.#was,
    );
    this.#showFindings();
  }

  /**
   * What the server found at this field.
   *
   * @param {Finding[]} errors
   * @param {Finding[]} warnings
   */
  place(errors, warnings) {
    this.#errors = errors;
    this.#warnings = warnings;
    this.#showFindings();
  }

  /**
   * Marks a value that is not the template's.
   *
   * @param {any} before what it was; undefined: nothing to compare with
   * @param {boolean} changed
   */
  mark(before, changed) {
    const field = this.#field;
    this.classList.toggle("changed", changed);
    this.#was.hidden = !changed;
    if (!changed || !field) return;
    const text = field.kind === "switch" || field.kind === "choice" ? titleOf(String(before)) : `${shown(before, field)} ${unitText(field.unit)}`;
    show(this.#was, wasLine(text, this.name, () => this.#send(before, true)));
  }

  /** What people call it. */
  get name() {
    return this.#field ? titleOf(this.#field.pointer, this.#field.label) : "";
  }

  /** Whether what is typed cannot be a value at all. */
  get broken() {
    return this.#ownError !== "";
  }

  focus() {
    unfold(this);
    this.#control?.focus();
  }

  #edit() {
    const field = this.#field;
    const control = this.#control;
    if (!field || !control) return;
    const entry = control.type === "checkbox" ? { value: /** @type {HTMLInputElement} */ (control).checked } : entered(control.value, field);
    this.#ownError = entry.error ?? "";
    this.#errors = [];
    this.#warnings = [];
    this.#showFindings();
    this.#send(entry.error ? undefined : entry.value, false);
  }

  /**
   * A column of a spreadsheet becomes a list.
   *
   * @param {ClipboardEvent} event
   */
  #paste(event) {
    const text = event.clipboardData?.getData("text/plain") ?? "";
    if (this.#field?.kind !== "list" && this.#field?.kind !== "texts") return;
    if (!this.#control || !isTable(text)) return;
    event.preventDefault();
    this.#control.value = listOf(text);
    this.#edit();
  }

  /**
   * @param {any} value
   * @param {boolean} whole whether every input shall be drawn anew
   */
  #send(value, whole) {
    this.dispatchEvent(new CustomEvent("edit", { detail: { pointer: this.#field?.pointer, value, whole }, bubbles: true }));
  }

  #showFindings() {
    const field = this.#field;
    if (!field) return;
    const errors = this.#ownError ? [{ pointer: field.pointer, reason: this.#ownError }] : this.#errors;
    /** @param {Finding} finding */
    const advice = (finding) => {
      const value = advised(finding, field);
      if (value === null) return null;
      const text = typeof value === "string" ? titleOf(value) : `${shown(value, field)} ${unitText(field.unit)}`;
      return { text, use: () => this.#send(value, true) };
    };
    show(this.#message, findingLines(errors, this.#warnings, advice));
    this.classList.toggle("invalid", errors.length > 0);
    this.classList.toggle("doubtful", this.#warnings.length > 0);
    this.#control?.setAttribute("aria-invalid", String(errors.length > 0));
  }
}

/**
 * @param {Field} field
 * @param {any} value
 * @param {string} id
 * @returns {HTMLInputElement | HTMLSelectElement}
 */
function control(field, value, id) {
  const common = { id, "aria-describedby": `${id}-error ${id}-help` };
  if (field.kind === "choice") {
    return h("select", common, field.options.map((option) => h("option", { value: option, selected: option === value }, titleOf(option))));
  }
  if (field.kind === "switch") return h("input", { ...common, type: "checkbox", checked: Boolean(value) });
  const words = field.kind === "text" || field.kind === "texts" || field.kind === "list";
  return h("input", { ...common, type: "text", inputmode: words ? "text" : "decimal", autocomplete: "off", spellcheck: "false", value: shown(value, field) });
}

customElements.define("tb-field", FieldInput);
