// @ts-check
/** An entry of the library while it is edited; what is not saved outlives the page. */
import { same } from "./difference.js";
import { Drafts } from "./drafts.js";
import { entryOf, kindOf, studyAround } from "./library-parts.js";
import { withValue } from "./pointer.js";
import { alternative } from "./study-origin.js";

/** @typedef {import("./types.js").LibraryItem} Item */
/** @typedef {import("./types.js").LibraryEntry} Entry */
/** @typedef {import("./types.js").Template} Template */
/** @typedef {"name" | "source" | "confidence"} Text */
/** @typedef {{ name: string, source: string, confidence: string, value: any }} Content */

export class LibraryEdit {
  /**
   * @param {Item} item as it is saved
   * @param {Template[]} templates
   * @param {Drafts} [drafts]
   */
  constructor(item, templates, drafts = new Drafts()) {
    this.item = item;
    this.templates = templates;
    this.drafts = drafts;
    /** The study's field that the entry is a value of. */
    this.part = kindOf(item.kind)?.part ?? "";
    const draft = drafts.get(this.#source);
    const saved = this.#saved;
    /** When the draft was kept that this began with. [ms] @type {number | null} */
    this.resumed = draft && !same(draft.value, saved) ? draft.saved : null;
    /** @type {Content} */
    this.content = draft && this.resumed !== null ? { ...saved, ...draft.value } : saved;
  }

  /** A study around the part, for drawing and for the form. */
  get study() {
    return studyAround(this.part, this.content.value, this.templates);
  }

  /** What is sent to keep it. @returns {Entry} */
  get entry() {
    const { name, source, confidence, value } = this.content;
    return entryOf({ name: name.trim(), source: source.trim(), confidence: confidence.trim(), remarks: this.item.remarks, value }, this.item.value);
  }

  /**
   * @param {string} pointer into the study around it
   * @param {any} value
   * @param {import("./form-plan.js").Option} [option] the alternative that was chosen
   */
  set(pointer, value, option) {
    const saved = studyAround(this.part, this.item.value, this.templates);
    const chosen = option ? alternative({ study: saved, examples: this.templates }, pointer, option) : value;
    this.replace(/** @type {any} */ (withValue(this.study, pointer, chosen))[this.part]);
  }

  /** Another value altogether, as the JSON tab gives it. @param {any} value */
  replace(value) {
    this.#keep({ ...this.content, value });
  }

  /**
   * @param {Text} name
   * @param {string} text
   */
  write(name, text) {
    this.#keep({ ...this.content, [name]: text });
  }

  /** Back to what is saved: after saving it, or because nobody wants the changes. */
  restart() {
    this.#keep(this.#saved);
  }

  /** @returns {Content} */
  get #saved() {
    const { name, source, confidence, value } = this.item;
    return { name, source, confidence, value };
  }

  get #source() {
    return `library ${this.item.kind}/${this.item.id}`;
  }

  /** @param {Content} content */
  #keep(content) {
    this.content = content;
    this.drafts.keep(this.#source, same(content, this.#saved) ? null : { value: content, saved: Date.now() });
  }
}
