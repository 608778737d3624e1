// @ts-check
/** What the page knows, in one place; components listen to the keys they show. */

export class Store extends EventTarget {
  /** @type {Map<string, any>} */
  #values = new Map();

  /** @param {string} key */
  get(key) {
    return this.#values.get(key);
  }

  /**
   * Keeps a value and tells everyone who listens to its key.
   *
   * @param {string} key
   * @param {any} value
   */
  set(key, value) {
    this.#values.set(key, value);
    this.dispatchEvent(new CustomEvent(key, { detail: value }));
  }

  /**
   * Calls back now (if there is a value) and on every change, until the signal aborts.
   *
   * @param {string} key
   * @param {(value: any) => void} callback
   * @param {AbortSignal} [signal]
   */
  watch(key, callback, signal) {
    this.addEventListener(key, (event) => callback(/** @type {CustomEvent} */ (event).detail), {
      signal,
    });
    if (this.#values.has(key)) callback(this.#values.get(key));
  }
}

export const store = new Store();
