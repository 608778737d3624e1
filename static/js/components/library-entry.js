// @ts-check
/** One entry of the library: drawn, with its figures; cloned, edited, exported, deleted. */
import { api, ApiError, libraryUrl } from "../api.js";
import { h, show } from "../dom.js";
import { LibraryEdit } from "../library-edit.js";
import { copyOf, kindOf } from "../library-parts.js";
import { link, remember } from "../router.js";
import { confirmed } from "./confirm.js";
import { LibraryDrawing } from "./library-drawing.js";
import { LibraryFigures } from "./library-figures.js";
import { LibraryForm } from "./library-form.js";

/** @typedef {import("../types.js").LibraryItem} Item */
/** @typedef {{ templates: import("../types.js").Template[], document: any }} Known */

export class LibraryEntry extends HTMLElement {
  /** @type {Item} */
  #item = /** @type {any} */ (null);
  /** @type {Known} */
  #known = { templates: [], document: null };
  #drawing = /** @type {LibraryDrawing} */ (h("tb-library-drawing"));
  #said = h("div", { role: "alert" });
  #place = h("div", { class: "library-place" });
  #tools = h("div", { class: "row" });

  /**
   * @param {Item} item
   * @param {Known} known
   * @param {boolean} editing
   */
  bind(item, known, editing) {
    this.#item = item;
    this.#known = known;
    const kind = kindOf(item.kind);
    document.title = `${item.name} · Library · Trainbridge`;
    show(
      this,
      h("p", { class: "crumb" }, h("a", { href: link("library") }, "Library"), " / ", h("a", { href: link("library", item.kind) }, kind?.title)),
      h("div", { class: "row spread library-head" }, h("h1", null, item.name), this.#tools),
      this.#said,
      h("div", { class: "card library-picture" }, this.#drawing),
      this.#place,
    );
    this.#draw(item.value);
    if (editing && !item.built_in) this.#edit();
    else this.#read();
  }

  #actions() {
    const { built_in: fixed, kind, id, name } = this.#item;
    const file = `${name.replace(/[^\w-]+/g, "-").slice(0, 60)}.json`;
    show(
      this.#tools,
      h("button", { type: "button", class: fixed ? "primary" : null, onclick: () => void this.#clone() }, "Clone"),
      !fixed && h("button", { type: "button", onclick: () => this.#edit() }, "Edit"),
      h("a", { class: "button", href: libraryUrl(kind, id), download: file }, "Export JSON"),
      !fixed && h("button", { type: "button", class: "danger", onclick: () => void this.#remove() }, "Delete"),
    );
  }

  #read() {
    remember("edit", null);
    this.#actions();
    const { source, confidence, built_in: fixed, changed } = this.#item;
    const figures = /** @type {LibraryFigures} */ (h("tb-library-figures"));
    figures.bind(this.#item, this.#known.templates, this.#known.document);
    show(
      this.#place,
      this.#unsaved(),
      h(
        "dl",
        { class: "card library-about basis" },
        pair("Source", source || "none given"),
        pair("Confidence", confidence || "not stated"),
        pair("Kept", fixed ? "comes with the solver; clone it to change it" : `changed ${new Date(changed ?? 0).toLocaleString()}`),
      ),
      h("div", { class: "card library-values" }, h("h2", null, "Figures"), figures),
    );
  }

  #edit() {
    remember("edit", "1");
    show(this.#tools);
    const model = this.#model();
    const form = /** @type {LibraryForm} */ (h("tb-library-form"));
    form.addEventListener("keep", () => void this.#save(form, model));
    form.addEventListener("leave", () => this.#discard());
    form.addEventListener("drawn", () => this.#draw(model.content.value));
    show(this.#place, form);
    form.bind(model, this.#known.document);
    this.#draw(model.content.value);
  }

  /** What is edited: as it is saved, or the draft of a visit before. */
  #model() {
    return new LibraryEdit(this.#item, this.#known.templates);
  }

  #discard() {
    this.#model().restart();
    show(this.#said);
    this.bind(this.#item, this.#known, false);
  }

  /** @param {any} value */
  #draw(value) {
    this.#drawing.bind(this.#item.kind, value, this.#known.templates);
  }

  /** Where changes wait that nobody saved: the ways to go on. */
  #unsaved() {
    if (this.#item.built_in || this.#model().resumed === null) return null;
    return h("div", { class: "notice wait" },
      h("p", null, "Changes of this entry wait to be saved. ",
        h("button", { type: "button", class: "link", onclick: () => this.#edit() }, "Go on editing"), " or ",
        h("button", { type: "button", class: "link", onclick: () => this.#discard() }, "discard them"), ".")); // prettier-ignore
  }

  /**
   * @param {LibraryForm} form
   * @param {LibraryEdit} model
   */
  async #save(form, model) {
    form.busy = true;
    try {
      const saved = await api.changeEntry(this.#item.kind, this.#item.id, model.entry);
      model.restart();
      show(this.#said);
      if (this.isConnected) this.bind(saved, this.#known, false);
    } catch (error) {
      form.busy = false;
      const findings = error instanceof ApiError ? error.findings : [];
      if (findings.length) form.place(findings);
      this.#complain(findings.length ? "Not saved: mend what is marked below." : /** @type {Error} */ (error).message);
    }
  }

  async #clone() {
    await this.#changing(async () => {
      const made = await api.addEntry(this.#item.kind, copyOf(this.#item));
      if (this.isConnected) location.hash = `${link("library", made.kind, made.id)}?edit=1`;
    });
  }

  async #remove() {
    const words = "Studies and jobs that took a copy keep it. This cannot be undone.";
    if (!(await confirmed({ question: `Delete “${this.#item.name}”?`, words, action: "Delete" }))) return;
    await this.#changing(async () => {
      await api.removeEntry(this.#item.kind, this.#item.id);
      this.#model().restart();
      if (this.isConnected) location.hash = link("library", this.#item.kind);
    });
  }

  /** @param {() => Promise<void>} change */
  async #changing(change) {
    try {
      await change();
    } catch (error) {
      this.#complain(/** @type {Error} */ (error).message);
    }
  }

  /** @param {string} words */
  #complain(words) {
    show(this.#said, h("div", { class: "notice bad" }, h("p", null, words)));
  }
}

/**
 * @param {string} term
 * @param {string} text
 */
const pair = (term, text) => h("div", null, h("dt", null, term), h("dd", null, text));

customElements.define("tb-library-entry", LibraryEntry);
