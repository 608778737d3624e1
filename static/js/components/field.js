// @ts-check
/** One input of a form with its unit, bounds, help and errors. Emits `edit` {pointer, value}. */
import { h, show } from "../dom.js";
import { entered, range, shown } from "../entry.js";
import { label, unitText } from "../format.js";
import { helpOf, titleOf } from "../titles.js";

/** @typedef {import("../schema.js").Field} Field */
/** @typedef {import("../types.js").Finding} Finding */

export class FieldInput extends HTMLElement {
  /** @type {Field | null} */
  #field = null;
  #ownError = "";
  /** @type {Finding[]} */
  #findings = [];
  /** @type {HTMLElement} */
  #message = h("p", { class: "field-error" });
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
    this.#control = this.#makeControl(field, value, id);
    this.#message.id = `${id}-error`;
    const limits = range(field);
    this.dataset.pointer = field.pointer;
    show(
      this,
      h("label", { for: id }, this.name),
      h("div", { class: "field-control" }, this.#control, field.unit && unitText(field.unit) && h("span", { class: "unit" }, unitText(field.unit))),
      this.#message,
      h("p", { class: "field-help", id: `${id}-help` }, helpOf(field.pointer, field.help), limits && h("span", { class: "limits" }, limits)),
    );
    this.#showErrors();
  }

  /** What the server found at this field. @param {Finding[]} findings */
  set findings(findings) {
    this.#findings = findings;
    this.#showErrors();
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
    const folded = this.closest("details");
    if (folded) folded.open = true;
    this.#control?.focus();
  }

  /**
   * @param {Field} field
   * @param {any} value
   * @param {string} id
   */
  #makeControl(field, value, id) {
    const common = { id, "aria-describedby": `${id}-error ${id}-help` };
    if (field.kind === "choice") {
      const options = field.options.map((option) =>
        h("option", { value: option, selected: option === value }, label(option)),
      );
      return h("select", { ...common, onchange: () => this.#edit() }, options);
    }
    if (field.kind === "switch") {
      return h("input", { ...common, type: "checkbox", checked: value, onchange: () => this.#edit() });
    }
    const mode = field.kind === "text" ? "text" : "decimal";
    return h("input", { ...common, type: "text", inputmode: mode, autocomplete: "off", spellcheck: "false", value: shown(value, field), oninput: () => this.#edit() });
  }

  #edit() {
    const field = this.#field;
    const control = this.#control;
    if (!field || !control) return;
    const entry =
      field.kind === "switch"
        ? { value: /** @type {HTMLInputElement} */ (control).checked }
        : entered(control.value, field);
    this.#ownError = entry.error ?? "";
    this.#findings = [];
    this.#showErrors();
    const detail = { pointer: field.pointer, value: entry.error ? undefined : entry.value };
    this.dispatchEvent(new CustomEvent("edit", { detail, bubbles: true }));
  }

  #showErrors() {
    const said = this.#ownError
      ? [this.#ownError]
      : this.#findings.map((finding) => sentence(finding));
    show(this.#message, said.join(" "));
    this.#message.hidden = !said.length;
    this.classList.toggle("invalid", said.length > 0);
    this.#control?.setAttribute("aria-invalid", String(said.length > 0));
  }
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

customElements.define("tb-field", FieldInput);
