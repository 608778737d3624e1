// @ts-check
/**
 * What is looked at, shared by the 3D view, the plots and the controls of a job page.
 *
 * Whoever changes something says so here; everyone else hears `change` with what is new. The time
 * moves too often for that: it has its own cursor. The address follows both.
 */
import { AddressWriter } from "./address-writer.js";
import { TimeCursor } from "./time-cursor.js";
import { addressOf, lookOf } from "./view-address.js";

/** @typedef {import("./view-address.js").Look} Look */

export class RunView extends EventTarget {
  cursor = new TimeCursor();
  /** Height of the slab: what is pressed on its map lies there. [m] */
  slabLevel = 0;
  /** @type {Look} */
  #look;
  #address = new AddressWriter();

  /** @param {URLSearchParams} query of the address */
  constructor(query) {
    super();
    this.#look = lookOf(query);
    this.cursor.addEventListener("change", (event) => {
      const { reason, time } = /** @type {CustomEvent} */ (event).detail;
      if (reason === "seek" || reason === "pause") this.set({ time });
    });
  }

  /** From now on the address is another page's. */
  close() {
    this.#address.close();
  }

  /** @returns {Readonly<Look>} */
  get look() {
    return this.#look;
  }

  /**
   * Changes some of it, tells everyone, and writes it into the address.
   *
   * @param {Partial<Look>} change
   */
  set(change) {
    this.#look = { ...this.#look, ...change };
    this.#address.write(addressOf(change));
    this.dispatchEvent(new CustomEvent("change", { detail: change }));
  }

  /**
   * Calls back with what changed, where any of these parts did.
   *
   * @param {(keyof Look)[]} parts
   * @param {(look: Readonly<Look>) => void} callback
   * @param {AbortSignal} signal
   */
  watch(parts, callback, signal) {
    this.addEventListener(
      "change",
      (event) => {
        const change = /** @type {CustomEvent} */ (event).detail;
        if (parts.some((part) => part in change)) callback(this.#look);
      },
      { signal },
    );
  }
}
