// @ts-check
/** A study while it is edited: what it came from, what can be undone, what is kept for tomorrow. */
import { differences, same } from "./difference.js";
import { Drafts } from "./drafts.js";
import { History } from "./history.js";
import { at, withValue } from "./pointer.js";
import { completed } from "./schema.js";

/** @typedef {import("./types.js").Study} Study */
/**
 * @typedef {object} Origin
 * @property {string} source its address: a template's or a job's
 * @property {string} kind of the job
 * @property {Study} study as it came
 */
/** How a change came about; only typing leaves the inputs as they stand. @typedef {"typing" | "whole" | "source"} Way */

/** Emits `change` {way}. */
export class StudyModel extends EventTarget {
  /**
   * @param {Origin} origin
   * @param {any} document the OpenAPI document
   * @param {Drafts} drafts
   */
  constructor(origin, document, drafts) {
    super();
    this.document = document;
    this.schema = document.components?.schemas?.Study ?? {};
    this.kind = origin.kind;
    this.source = origin.source;
    this.original = completed(this.schema, origin.study, document);
    this.drafts = drafts;
    const draft = drafts.get(origin.source);
    /** When the draft was kept that this began with. [ms] @type {number | null} */
    this.resumed = draft && !same(this.#whole(draft.value), this.original) ? draft.saved : null;
    /** @type {History<Study>} */
    this.history = new History(this.original);
    if (draft && this.resumed !== null) this.history.push(this.#whole(draft.value), "", 0);
  }

  get study() {
    return this.history.now;
  }

  /** Pointers of what differs from where it came from. */
  get changes() {
    return differences(this.original, this.study);
  }

  /**
   * @param {string} pointer
   * @param {any} value
   * @param {Way} way
   */
  set(pointer, value, way) {
    const changed = withValue(this.study, pointer, value);
    this.#keep(changed, way === "typing" ? pointer : "", way);
  }

  /**
   * Another study altogether, as the JSON tab gives it.
   *
   * @param {Study} study
   * @param {Way} way
   */
  replace(study, way) {
    const whole = this.#whole(study);
    if (same(whole, this.study)) this.#tell(way); // what was broken meanwhile is whole again
    else this.#keep(whole, way, way);
  }

  /** Back to where it came from, as a step that can be undone. */
  restart() {
    this.#keep(this.original, "", "whole");
  }

  undo() {
    if (this.history.undo()) this.#tell("whole");
  }

  redo() {
    if (this.history.redo()) this.#tell("whole");
  }

  /**
   * What a place held at first, undefined where there was none.
   *
   * @param {string} pointer
   */
  before(pointer) {
    return at(this.original, pointer);
  }

  /** @param {Study} study @returns {Study} */
  #whole(study) {
    return completed(this.schema, study, this.document);
  }

  /**
   * @param {Study} study
   * @param {string} place
   * @param {Way} way
   */
  #keep(study, place, way) {
    this.history.push(study, place, Date.now());
    this.#tell(way);
  }

  /** @param {Way} way */
  #tell(way) {
    const changed = !same(this.study, this.original);
    this.drafts.keep(this.source, changed ? { value: this.study, saved: Date.now() } : null);
    this.dispatchEvent(new CustomEvent("change", { detail: { way } }));
  }
}
