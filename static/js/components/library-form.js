// @ts-check
/**
 * An entry of the library while it is edited: name, source, confidence and every figure, from the
 * solver's schema. Emits `keep` with the entry, `leave`, and `drawn` {value} after each change.
 */
import { h, show } from "../dom.js";
import { planOf } from "../form-plan.js";
import { entryOf, kindOf, studyAround } from "../library-parts.js";
import { at, nearest, withValue } from "../pointer.js";
import { schemaAt } from "../schema.js";
import { alternative } from "../study-origin.js";
import { sentence } from "./finding-lines.js";
import { nodeElements } from "./study-nodes.js";

/** @typedef {import("../types.js").LibraryItem} Item */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("./study-nodes.js").Place} Place */

const TEXTS = /** @type {const} */ ([
  ["name", "Name", 120, ""],
  ["source", "Source", 1000, "Where its figures come from."],
  ["confidence", "Confidence", 500, "How far they can be trusted."],
]);

export class LibraryForm extends HTMLElement {
  /** @type {Item | null} */
  #item = null;
  /** @type {any} */
  #document = null;
  /** @type {any} a study around the part */
  #study = {};
  /** The study around the part as it came. @type {any} */
  #original = {};
  /** @type {import("../types.js").Template[]} */
  #examples = [];
  #part = "";
  #inputs = h("div", { class: "card section" });
  #elsewhere = h("div", { role: "alert" });
  #save = h("button", { type: "submit", class: "primary" }, "Save");

  /**
   * @param {Item} item
   * @param {import("../types.js").Template[]} templates
   * @param {any} document the OpenAPI document
   */
  bind(item, templates, document) {
    this.#item = item;
    this.#document = document;
    this.#part = kindOf(item.kind)?.part ?? "";
    this.#study = studyAround(this.#part, item.value, templates);
    this.#original = this.#study;
    this.#examples = templates;
    this.addEventListener("edit", (event) => this.#edited(/** @type {CustomEvent} */ (event).detail));
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      this.#keep();
    };
    show(
      this,
      h(
        "form",
        { class: "stack", onsubmit: submit, novalidate: true },
        h("div", { class: "card stack library-about" }, TEXTS.map(([name, title, most, help]) => this.#text(item, name, title, most, help))),
        this.#inputs,
        this.#elsewhere,
        h("div", { class: "row library-actions" }, this.#save, h("button", { type: "button", onclick: () => this.dispatchEvent(new CustomEvent("leave")) }, "Cancel")),
      ),
    );
    this.#draw();
    /** @type {HTMLElement} */ (this.querySelector("#entry-name")).focus({ preventScroll: true });
  }

  /** What the server found. @param {Finding[]} findings */
  place(findings) {
    const places = this.#places();
    const pointers = places.map((place) => place.dataset.pointer ?? "");
    const homes = findings.map((finding) => nearest(finding.pointer.replace(/^\/value/, `/${this.#part}`), pointers));
    for (const place of places) {
      const own = findings.filter((_, index) => homes[index] === place.dataset.pointer);
      place.place(own, []);
      if (own.length) place.closest("details")?.setAttribute("open", "");
    }
    const rest = findings.filter((_, index) => homes[index] === null);
    show(this.#elsewhere, rest.map((finding) => h("div", { class: "notice bad" }, h("p", null, sentence(finding), " ", h("span", { class: "mono" }, finding.pointer)))));
    if (findings.length) (places.find((place) => homes.includes(place.dataset.pointer ?? "")) ?? this.#save).focus();
  }

  /** @param {boolean} busy */
  set busy(busy) {
    this.#save.disabled = busy;
    show(this.#save, busy ? "Saving…" : "Save");
  }

  /** @returns {Place[]} */
  #places() {
    return [.../** @type {NodeListOf<Place>} */ (this.querySelectorAll("tb-field, tb-choice, tb-table"))];
  }

  /**
   * @param {Item} item
   * @param {"name" | "source" | "confidence"} name
   * @param {string} title
   * @param {number} most
   * @param {string} help
   */
  #text(item, name, title, most, help) {
    const id = `entry-${name}`;
    const input = h("input", { id, name, type: "text", maxlength: most, autocomplete: "off", value: item[name], "aria-describedby": help ? `${id}-help` : null });
    return h("div", { class: "entry-text" }, h("label", { for: id }, title), input, help && h("p", { class: "field-help", id: `${id}-help` }, help));
  }

  #draw() {
    const pointer = `/${this.#part}`;
    const schema = schemaAt(this.#document.components.schemas.Study, this.#study, pointer, this.#document);
    const node = schema && planOf(schema, at(this.#study, pointer), pointer, this.#document);
    show(this.#inputs, node && nodeElements([node], this.#study, 2));
  }

  /** @param {{ pointer: string, value: any, whole?: boolean, option?: import("../form-plan.js").Option }} change */
  #edited({ pointer, value, whole, option }) {
    if (value === undefined) return; // what is typed is no value: the input says so
    const chosen = option ? alternative(/** @type {any} */ ({ study: this.#original, examples: this.#examples }), pointer, option) : value;
    this.#study = withValue(this.#study, pointer, chosen);
    if (whole) this.#draw();
    this.dispatchEvent(new CustomEvent("drawn", { detail: { value: this.#study[this.#part] } }));
  }

  #keep() {
    const item = this.#item;
    const wrong = this.#places().find((place) => place.broken);
    if (wrong) wrong.focus();
    if (wrong || !item) return;
    const texts = Object.fromEntries(TEXTS.map(([name]) => [name, /** @type {HTMLInputElement} */ (this.querySelector(`#entry-${name}`)).value.trim()]));
    const entry = entryOf({ .../** @type {any} */ (texts), remarks: item.remarks, value: this.#study[this.#part] }, item.value);
    this.dispatchEvent(new CustomEvent("keep", { detail: entry }));
  }
}

customElements.define("tb-library-form", LibraryForm);
