// @ts-check
/** What can be undone and done again. Pure: the clock is the caller's. */

/** Changes of one place within this time are one step back. [ms] */
const TOGETHER = 1200;
/** Steps that are kept. */
const KEPT = 200;

/** @template T */
export class History {
  /** @type {T[]} */
  #past = [];
  /** @type {T[]} */
  #future = [];
  /** @type {T} */
  #now;
  #place = "";
  #when = Number.NEGATIVE_INFINITY;

  /** @param {T} now */
  constructor(now) {
    this.#now = now;
  }

  get now() {
    return this.#now;
  }

  get canUndo() {
    return this.#past.length > 0;
  }

  get canRedo() {
    return this.#future.length > 0;
  }

  /**
   * Keeps a new state. Quick changes of the same place, as typing makes them, are one step.
   *
   * @param {T} state
   * @param {string} place empty: a step of its own
   * @param {number} when [ms]
   */
  push(state, place, when) {
    const same = place !== "" && place === this.#place && when - this.#when < TOGETHER;
    if (!same) this.#past = [...this.#past, this.#now].slice(-KEPT);
    this.#now = state;
    this.#future = [];
    this.#place = place;
    this.#when = when;
  }

  /** The state before, or null at the beginning. @returns {T | null} */
  undo() {
    const before = this.#past.pop();
    if (before === undefined) return null;
    this.#future.push(this.#now);
    return this.#go(before);
  }

  /** The state that was undone last, or null. @returns {T | null} */
  redo() {
    const after = this.#future.pop();
    if (after === undefined) return null;
    this.#past.push(this.#now);
    return this.#go(after);
  }

  /** @param {T} state */
  #go(state) {
    this.#now = state;
    this.#place = "";
    return state;
  }
}
