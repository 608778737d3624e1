// @ts-check
/**
 * The inputs of a study, drawn from the solver's schema. Emits `study` with the changed study.
 *
 * The first group is what most people change; every other input is folded below, nothing is left
 * out.
 */
import { h, show } from "../dom.js";
import { label } from "../format.js";
import { at, nearest, withValue } from "../pointer.js";
import { chosen, defaults, field, fieldsUnder, schemaAt, variants } from "../schema.js";
import { FORMULAS, titleOf } from "../titles.js";
import { FieldInput } from "./field.js";

/** @typedef {import("../types.js").Study} Study */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../schema.js").Schema} Schema */
/** @typedef {import("../schema.js").Field} Field */

/** What most people change, in this order. */
const BASIC = ["/name", "/sweep/speeds", "/mesh_level", "/line_speed", "/outputs/cut_off_frequency"];
/** The union whose alternative is chosen in the first group. */
const IRREGULARITY = "/irregularity";
const HIDDEN = new Set(["/schema_version"]);

export class StudyForm extends HTMLElement {
  /** @type {Study} */
  #study = {};
  /** @type {Schema} */
  #document = {};
  /** @type {Schema} */
  #schema = {};

  connectedCallback() {
    this.addEventListener("edit", (event) => {
      const { pointer, value } = /** @type {CustomEvent} */ (event).detail;
      if (value !== undefined) this.#change(pointer, value);
      else this.dispatchEvent(new CustomEvent("broken", { bubbles: true }));
    });
  }

  /**
   * @param {Study} study
   * @param {Schema} document the OpenAPI document
   */
  bind(study, document) {
    this.#study = study;
    this.#document = document;
    this.#schema = document.components?.schemas?.Study ?? {};
    this.#draw();
  }

  /** Whether a field holds no value at all. */
  get broken() {
    return this.#fields().some((item) => item.broken);
  }

  /** The fields with something to mend. @returns {FieldInput[]} */
  get marked() {
    return this.#fields().filter((item) => item.classList.contains("invalid"));
  }

  /**
   * Shows each finding at its field.
   *
   * @param {Finding[]} findings
   * @returns {Finding[]} those that belong to no field
   */
  place(findings) {
    const fields = this.#fields();
    const pointers = fields.map((item) => item.dataset.pointer ?? "");
    const homes = findings.map((finding) => nearest(finding.pointer, pointers));
    for (const item of fields) {
      item.findings = findings.filter((_, index) => homes[index] === item.dataset.pointer);
    }
    for (const item of fields) {
      const folded = item.closest("details");
      if (folded && homes.includes(item.dataset.pointer ?? "")) folded.open = true;
    }
    return findings.filter((_, index) => homes[index] === null);
  }

  #fields() {
    return [.../** @type {NodeListOf<FieldInput>} */ (this.querySelectorAll("tb-field"))];
  }

  /**
   * @param {string} pointer
   * @param {any} value
   */
  #change(pointer, value) {
    this.#study = withValue(this.#study, pointer, value);
    this.dispatchEvent(new CustomEvent("study", { detail: this.#study, bubbles: true }));
  }

  #draw() {
    const basic = BASIC.map((pointer) => this.#fieldAt(pointer)).filter((item) => item !== null);
    show(
      this,
      h("fieldset", { class: "card" }, h("legend", null, "Crossing"), h("div", { class: "fields" }, basic)),
      this.#irregularity(),
      Object.keys(chosen(this.#schema, this.#study, this.#document).properties ?? {})
        .filter((key) => `/${key}` !== IRREGULARITY)
        .map((key) => this.#section(key)),
    );
  }

  #irregularity() {
    const part = schemaAt(this.#schema, this.#study, IRREGULARITY, this.#document);
    if (!part) return null;
    const value = at(this.#study, IRREGULARITY);
    const choices = variants(part, this.#document);
    const inner = fieldsUnder(part, value, IRREGULARITY, this.#document);
    return h(
      "fieldset",
      { class: "card" },
      h("legend", null, "Irregularity of the rails"),
      h(
        "div",
        { class: "choices", role: "radiogroup", "aria-label": "Kind of irregularity" },
        choices.map(({ tag, schema }) =>
          h(
            "label",
            { class: "choice" },
            h("input", {
              type: "radio",
              name: "irregularity",
              value: tag,
              checked: value?.type === tag,
              onchange: () => this.#choose(tag, schema),
            }),
            titleOf(tag),
            FORMULAS[tag] && h("span", { class: "soft" }, FORMULAS[tag]),
          ),
        ),
      ),
      inner.length > 0 && h("div", { class: "fields" }, inner.map((item) => this.#input(item))),
    );
  }

  /**
   * @param {string} tag
   * @param {Schema} schema
   */
  #choose(tag, schema) {
    this.#change(IRREGULARITY, { ...defaults(schema, this.#document), type: tag });
    this.#draw();
    /** @type {HTMLElement | null} */ (this.querySelector(`input[value="${tag}"]`))?.focus();
  }

  /** @param {string} key */
  #section(key) {
    const part = schemaAt(this.#schema, this.#study, `/${key}`, this.#document);
    const fields = fieldsUnder(part ?? {}, this.#study[key], `/${key}`, this.#document).filter(
      (item) => !BASIC.includes(item.pointer) && !HIDDEN.has(item.pointer),
    );
    if (!fields.length) return null;
    return h(
      "details",
      { class: "card section" },
      h("summary", null, label(key), h("span", { class: "soft small" }, `${fields.length} input${fields.length > 1 ? "s" : ""}`)),
      groups(fields).map(([title, items]) => [
        title && h("h3", null, title),
        h("div", { class: "fields" }, items.map((item) => this.#input(item))),
      ]),
    );
  }

  /** @param {string} pointer */
  #fieldAt(pointer) {
    const part = schemaAt(this.#schema, this.#study, pointer, this.#document);
    const found = part && field(part, at(this.#study, pointer), pointer, this.#document);
    return found ? this.#input(found) : null;
  }

  /** @param {Field} item */
  #input(item) {
    const element = /** @type {FieldInput} */ (h("tb-field"));
    element.bind(item, at(this.#study, item.pointer));
    return element;
  }
}

/**
 * Fields by the part of the section that holds them, in order.
 *
 * @param {Field[]} fields
 * @returns {[string, Field[]][]}
 */
function groups(fields) {
  /** @type {Map<string, Field[]>} */
  const found = new Map();
  for (const item of fields) {
    const inner = item.pointer.split("/").slice(2, -1);
    const title = inner.map((part) => (/^\d+$/.test(part) ? `${Number(part) + 1}` : label(part))).join(" ");
    found.set(title, [...(found.get(title) ?? []), item]);
  }
  return [...found];
}

customElements.define("tb-study-form", StudyForm);
