// @ts-check
/**
 * An entry of the library while it is edited: name, source, confidence and every figure, from the
 * solver's schema or as JSON. Emits `keep`, `leave`, and `drawn` after each change of the figures.
 */
import { h, show } from "../dom.js";
import { planOf } from "../form-plan.js";
import { kindOf } from "../library-parts.js";
import { at, nearest } from "../pointer.js";
import { schemaAt } from "../schema.js";
import { sentence } from "./finding-lines.js";
import { segments } from "./segments.js";
import { focusOf, refocus, unfold } from "./study-focus.js";
import { StudyJson } from "./study-json.js";
import { nodeElements } from "./study-nodes.js";
import { resumedNotice } from "./study-notices.js";
import { VIEWS } from "./study-toolbar.js";

/** @typedef {import("../library-edit.js").LibraryEdit} LibraryEdit */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("./study-nodes.js").Place} Place */

const TEXTS = /** @type {const} */ ([
  ["name", "Name", 120, ""],
  ["source", "Source", 1000, "Where its figures come from."],
  ["confidence", "Confidence", 500, "How far they can be trusted."],
]);

export class LibraryForm extends HTMLElement {
  /** @type {LibraryEdit} */
  #model = /** @type {any} */ (null);
  /** @type {any} */
  #document = null;
  #resumed = h("div", { role: "status" });
  #texts = h("div", { class: "card stack library-about" });
  #inputs = h("div", { class: "card section" });
  #json = /** @type {StudyJson} */ (h("tb-study-json", { hidden: true }));
  #elsewhere = h("div", { role: "alert" });
  #save = h("button", { type: "submit", class: "primary" }, "Save");

  /**
   * @param {LibraryEdit} model
   * @param {any} document the OpenAPI document
   */
  bind(model, document) {
    this.#model = model;
    this.#document = document;
    this.#json.called = `The ${kindOf(model.item.kind)?.one ?? "part"}`;
    this.addEventListener("edit", (event) => this.#edited(/** @type {CustomEvent} */ (event).detail));
    this.addEventListener("source", (event) => this.#replaced(/** @type {CustomEvent} */ (event).detail.value));
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      this.#keep();
    };
    const leave = () => this.dispatchEvent(new CustomEvent("leave"));
    show(
      this,
      this.#resumed,
      h(
        "form",
        { class: "stack", onsubmit: submit, novalidate: true },
        this.#texts,
        segments({ legend: "Edit as", options: VIEWS, chosen: "form", choose: (view) => this.#view(view) }),
        this.#inputs,
        this.#json,
        this.#elsewhere,
        h("div", { class: "row library-actions" }, this.#save, h("button", { type: "button", onclick: leave }, "Cancel")),
      ),
    );
    this.#show();
    const restart = () => {
      model.restart();
      this.#show();
      this.#tell();
    };
    show(this.#resumed, resumedNotice({ resumed: model.resumed, restart }, "what is saved", () => show(this.#resumed)));
    /** @type {HTMLElement} */ (this.querySelector("#entry-name")).focus({ preventScroll: true });
  }

  /** What the server found. @param {Finding[]} findings */
  place(findings) {
    const places = this.#places();
    const pointers = places.map((place) => place.dataset.pointer ?? "");
    const homes = findings.map((finding) => nearest(finding.pointer.replace(/^\/value/, `/${this.#model.part}`), pointers));
    for (const place of places) {
      const own = findings.filter((_, index) => homes[index] === place.dataset.pointer);
      place.place(own, []);
      if (own.length) unfold(place);
    }
    this.#json.place(findings.filter(({ pointer }) => pointer.startsWith("/value")).map((finding) => ({ ...finding, pointer: finding.pointer.slice("/value".length) })), []);
    const rest = findings.filter((_, index) => homes[index] === null);
    show(this.#elsewhere, rest.map((finding) => h("div", { class: "notice bad" }, h("p", null, sentence(finding), " ", h("span", { class: "mono" }, finding.pointer)))));
    if (findings.length && this.#inputs.hidden) this.#json.focus();
    else if (findings.length) (places.find((place) => homes.includes(place.dataset.pointer ?? "")) ?? this.#save).focus();
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

  /** Everything anew, as the model has it. */
  #show() {
    show(this.#texts, TEXTS.map(([name, title, most, help]) => this.#text(name, title, most, help)));
    this.#json.study = this.#model.content.value;
    this.#draw();
  }

  /**
   * @param {"name" | "source" | "confidence"} name
   * @param {string} title
   * @param {number} most
   * @param {string} help
   */
  #text(name, title, most, help) {
    const id = `entry-${name}`;
    const write = () => this.#model.write(name, input.value);
    const input = h("input", { id, name, type: "text", maxlength: most, autocomplete: "off", value: this.#model.content[name], oninput: write, "aria-describedby": help ? `${id}-help` : null });
    return h("div", { class: "entry-text" }, h("label", { for: id }, title), input, help && h("p", { class: "field-help", id: `${id}-help` }, help));
  }

  /** The inputs of the figures anew; the focus stays. */
  #draw() {
    const { study, part } = this.#model;
    const focused = focusOf(this.#inputs);
    const schema = schemaAt(this.#document.components.schemas.Study, study, `/${part}`, this.#document);
    const node = schema && planOf(schema, at(study, `/${part}`), `/${part}`, this.#document);
    show(this.#inputs, node && nodeElements([node], study, 2));
    refocus(this.#inputs, focused);
  }

  /** @param {string} view */
  #view(view) {
    this.#inputs.hidden = view === "json";
    this.#json.hidden = view !== "json";
  }

  /** @param {{ pointer: string, value: any, whole?: boolean, option?: import("../form-plan.js").Option }} change */
  #edited({ pointer, value, whole, option }) {
    if (value === undefined) return; // what is typed is no value: the input says so
    this.#model.set(pointer, value, option);
    this.#json.study = this.#model.content.value;
    if (whole) this.#draw();
    this.#tell();
  }

  /** @param {any} value from the JSON text */
  #replaced(value) {
    this.#model.replace(value);
    this.#draw();
    this.#tell();
  }

  #tell() {
    this.dispatchEvent(new CustomEvent("drawn"));
  }

  #keep() {
    const wrong = this.#places().find((place) => place.broken);
    if (this.#json.broken) this.#json.focus();
    else if (wrong) wrong.focus();
    else this.dispatchEvent(new CustomEvent("keep"));
  }
}

customElements.define("tb-library-form", LibraryForm);
