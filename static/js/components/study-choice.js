// @ts-check
/** The choice of a kind: of train, viaduct, track, irregularity. Emits `edit` with the new part. */
import { h, show } from "../dom.js";
import { NOTHING } from "../form-plan.js";
import { FORMULAS, titleOf } from "../titles.js";
import { findingLines, wasLine } from "./finding-lines.js";
import { unfold } from "./study-focus.js";

/** @typedef {import("../form-plan.js").ChoiceNode} ChoiceNode */
/** @typedef {import("../types.js").Finding} Finding */

export class StudyChoice extends HTMLElement {
  /** @type {ChoiceNode | null} */
  #node = null;
  #message = h("div", { class: "field-message" });
  #was = h("p", { class: "was" });

  /** @param {ChoiceNode} node */
  bind(node) {
    this.#node = node;
    this.dataset.pointer = node.pointer;
    const name = `choice${node.pointer.replace(/[^\w]/g, "-")}`;
    const chosen = node.options.find((option) => option.tag === node.chosen);
    show(
      this,
      h("fieldset", null,
        h("legend", null, h("span", { class: "sr" }, `${node.title}: `), "Kind"),
        h("div", { class: "choices" }, node.options.map((option) =>
          h("label", { class: "choice" },
            h("input", { type: "radio", name, value: option.tag, checked: option.tag === node.chosen, onchange: () => this.#choose(option.tag) }),
            option.tag === NOTHING ? "None" : titleOf(option.tag),
          ))),
      ),
      (FORMULAS[node.chosen] || chosen?.help) && h("p", { class: "field-help" }, FORMULAS[node.chosen] && h("span", { class: "formula" }, FORMULAS[node.chosen]), FORMULAS[node.chosen] ? "" : firstLine(chosen?.help ?? "")),
      this.#message,
      this.#was,
    ); // prettier-ignore
    this.#was.hidden = true;
  }

  /**
   * @param {Finding[]} errors
   * @param {Finding[]} warnings
   */
  place(errors, warnings) {
    this.classList.toggle("invalid", errors.length > 0);
    show(this.#message, findingLines(errors, warnings, (finding) => this.#advice(finding)));
  }

  /**
   * @param {any} before the part as it was
   * @param {boolean} changed whether its kind is another one
   */
  mark(before, changed) {
    this.classList.toggle("changed", changed);
    this.#was.hidden = !changed;
    const node = this.#node;
    if (!changed || !node) return;
    show(this.#was, wasLine(before ? titleOf(before[this.#key]) : "none", node.title, () => this.#send(before)));
  }

  /**
   * Whether two parts are of one kind.
   *
   * @param {any} before
   * @param {any} now
   */
  sameKind(before, now) {
    return (before?.[this.#key] ?? NOTHING) === (now?.[this.#key] ?? NOTHING);
  }

  /** The property that names the kind. */
  get #key() {
    const pointer = this.#node?.tagPointer ?? "";
    return pointer.slice(pointer.lastIndexOf("/") + 1);
  }

  get name() {
    return this.#node?.title ?? "";
  }

  /** A choice always holds a value. */
  get broken() {
    return false;
  }

  focus() {
    unfold(this);
    /** @type {HTMLElement | null} */ (this.querySelector("input:checked") ?? this.querySelector("input"))?.focus();
  }

  /** @param {Finding} finding */
  #advice({ remedy = "" }) {
    const words = [...remedy.matchAll(/"([\w]+)"/g)].map((match) => match[1]);
    const others = this.#node?.options.filter((option) => words.includes(option.tag) && option.tag !== this.#node?.chosen) ?? [];
    return others.length ? { text: titleOf(others[0].tag).toLowerCase(), use: () => this.#choose(others[0].tag) } : null;
  }

  /** @param {string} tag */
  #choose(tag) {
    const option = this.#node?.options.find((item) => item.tag === tag);
    if (option) this.#send(option.initial, option);
  }

  /**
   * @param {any} value
   * @param {import("../form-plan.js").Option} [option] what was chosen; the page may know better values for it
   */
  #send(value, option) {
    this.dispatchEvent(new CustomEvent("edit", { detail: { pointer: this.#node?.pointer, value, whole: true, option }, bubbles: true }));
  }
}

/** The first sentences of a docstring. @param {string} text */
const firstLine = (text) => text.split("\n\n")[0].replace(/\n/g, " ");

customElements.define("tb-choice", StudyChoice);
