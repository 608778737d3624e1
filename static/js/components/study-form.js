// @ts-check
/**
 * The inputs of a study, drawn from the solver's schema in sections: basic ones open, the others
 * folded. Emits what its inputs emit; the page keeps the study.
 */
import { h, show } from "../dom.js";
import { planOf } from "../form-plan.js";
import { at, nearest } from "../pointer.js";
import { schemaAt } from "../schema.js";
import { folded, inputs, sectionsOf } from "../sections.js";
import { same } from "../difference.js";
import { LibraryChoice, libraryKind } from "./library-choice.js";
import { focusOf, refocus, unfold } from "./study-focus.js";
import { StudyChoice } from "./study-choice.js";
import { nodeElements } from "./study-nodes.js";

/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../form-plan.js").Node} Node */
/** @typedef {import("../sections.js").Section} Section */
/** @typedef {import("../study-model.js").StudyModel} StudyModel */
/** @typedef {import("./study-nodes.js").Place} Place */

/** Name of the fold around what the job does not read. */
const UNREAD = "unread";

export class StudyForm extends HTMLElement {
  /** @type {StudyModel | null} */
  #model = null;
  /** Sections whose advanced inputs are unfolded. @type {Set<string>} */
  #open = new Set();
  /** @type {{ errors: Finding[], warnings: Finding[] }} */
  #findings = { errors: [], warnings: [] };

  /** @param {StudyModel} model */
  bind(model) {
    this.#model = model;
    this.draw();
  }

  /** Every input anew, as after a change that is not typing; focus and folds stay. */
  draw() {
    const model = this.#model;
    if (!model) return;
    const focused = focusOf(this);
    const keys = Object.keys(model.schema.properties ?? {});
    const sections = sectionsOf(keys, model.kind, model.study.modes?.part);
    const drawn = /** @param {boolean} read */ (read) => sections.filter((section) => section.read === read).map((section) => this.#section(section, model));
    show(this, this.#name(model), drawn(true), this.#unread(drawn(false)));
    this.place(this.#findings.errors, this.#findings.warnings);
    this.refresh();
    refocus(this, focused);
  }

  /** Marks what differs from the template, at inputs and sections. */
  refresh() {
    const model = this.#model;
    if (!model) return;
    /** Parts of another kind than the template's: the choice bears the mark, not what it holds. @type {string[]} */
    const other = [];
    for (const place of this.#places()) {
      const pointer = place.dataset.pointer ?? "";
      const [before, now] = [model.before(pointer), at(model.study, pointer)];
      const choice = place instanceof StudyChoice;
      const changed = choice ? !place.sameKind(before, now) : before !== undefined && !same(before, now);
      const inside = other.some((part) => pointer.startsWith(`${part}/`));
      place.mark(before, changed && !inside);
      if (choice && changed) other.push(pointer);
    }
    for (const section of this.querySelectorAll("section")) {
      const count = section.querySelectorAll(".changed").length;
      const mark = section.querySelector(".section-mark");
      if (mark) show(mark, count ? [h("span", { class: "dot", "aria-hidden": "true" }), `${count} changed`] : null);
    }
  }

  /** The sections that the job reads, for the links that lead to them. @returns {HTMLElement[]} */
  get sections() {
    return [.../** @type {NodeListOf<HTMLElement>} */ (this.querySelectorAll(":scope > section[id]"))];
  }

  /**
   * Puts the focus at the input of a pointer, unfolded and in the middle of the page.
   *
   * @param {string} pointer
   */
  reach(pointer) {
    const home = nearest(pointer, this.#places().map((item) => item.dataset.pointer ?? ""));
    const place = this.#places().find((item) => item.dataset.pointer === home);
    place?.focus();
    place?.scrollIntoView({ block: "center" });
  }

  /** Whether an input holds no value at all. */
  get broken() {
    return this.#places().some((place) => place.broken);
  }

  /** The inputs with something to mend. @returns {Place[]} */
  get marked() {
    return this.#places().filter((place) => place.classList.contains("invalid"));
  }

  /**
   * Shows each finding at its input.
   *
   * @param {Finding[]} errors
   * @param {Finding[]} warnings
   * @returns {{ errors: Finding[], warnings: Finding[] }} those that belong to none
   */
  place(errors, warnings) {
    this.#findings = { errors, warnings };
    const places = this.#places();
    const pointers = places.map((place) => place.dataset.pointer ?? "");
    /** @param {Finding} finding */
    const home = (finding) => nearest(finding.pointer, pointers);
    for (const place of places) {
      const own = /** @param {Finding} finding */ (finding) => home(finding) === place.dataset.pointer;
      place.place(errors.filter(own), warnings.filter(own));
      if (errors.some(own)) unfold(place);
    }
    const lost = /** @param {Finding} finding */ (finding) => home(finding) === null;
    return { errors: errors.filter(lost), warnings: warnings.filter(lost) };
  }

  /** @returns {Place[]} */
  #places() {
    return [.../** @type {NodeListOf<Place>} */ (this.querySelectorAll("tb-field, tb-choice, tb-table"))];
  }

  /** @param {string} pointer @param {StudyModel} model */
  #plan(pointer, model) {
    const part = schemaAt(model.schema, model.study, pointer, model.document);
    return part && planOf(part, at(model.study, pointer), pointer, model.document);
  }

  /** @param {StudyModel} model */
  #name(model) {
    const node = this.#plan("/name", model);
    return node && h("section", { class: "card section", "aria-label": "Study" }, nodeElements([node], model.study));
  }

  /** @param {Section} section @param {StudyModel} model */
  #section(section, model) {
    const nodes = section.parts.map((pointer) => this.#plan(pointer, model)).filter((node) => node !== null);
    const { basic, advanced } = folded(nodes);
    if (!basic.length && !advanced.length) return null;
    const id = `section-${section.name}`;
    return h(
      "section",
      { class: "card section", id, "aria-labelledby": `${id}-title`, tabindex: "-1" },
      h("div", { class: "section-title" },
        h("h2", { id: `${id}-title` }, section.title),
        h("span", { class: "section-mark" }),
        this.#library(section)),
      nodeElements(basic, model.study),
      advanced.length > 0 && this.#advanced(section, advanced, model),
    ); // prettier-ignore
  }

  /** What a modal analysis does not look at, folded. @param {(HTMLElement | null)[]} sections */
  #unread(sections) {
    if (!sections.length) return null;
    const head = h("summary", null, "Not used by this modal analysis", h("span", { class: "soft small" }, `${sections.length} sections`));
    return h("details", { class: "unread", ...this.#fold(UNREAD) }, head, sections);
  }

  /** A fold that stays as it was when the inputs are drawn anew. @param {string} name */
  #fold(name) {
    return {
      open: this.#open.has(name),
      ontoggle: (/** @type {any} */ event) => event.target === event.currentTarget && this.#open[event.target.open ? "add" : "delete"](name),
    };
  }

  /** @param {Section} section @param {Node[]} nodes @param {StudyModel} model */
  #advanced(section, nodes, model) {
    const count = nodes.reduce((sum, node) => sum + inputs(node), 0);
    return h(
      "details",
      { class: "advanced", ...this.#fold(section.name) },
      h("summary", null, `${section.title}, advanced`, h("span", { class: "soft small" }, `${count} more input${count > 1 ? "s" : ""}`)),
      nodeElements(nodes, model.study),
    );
  }

  /** @param {Section} section */
  #library(section) {
    const kind = libraryKind(section.name);
    const [pointer] = section.parts;
    if (!kind) return null;
    const choice = /** @type {LibraryChoice} */ (h("tb-library-choice"));
    choice.bind(kind, section.title, pointer);
    return choice;
  }
}

customElements.define("tb-study-form", StudyForm);
