// @ts-check
/**
 * Writes what is looked at into the address, at once and then at a calm pace: browsers ignore or
 * refuse an address that changes with every step of a slider.
 */
import { remember } from "./router.js";

/** Browsers allow some ten changes a second for long. [ms] */
const PACE = 150;

export class AddressWriter {
  /** @type {Record<string, string | null>} */
  #waiting = {};
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #closed = false;
  #remember;
  #page;
  #first;

  /**
   * @param {(key: string, value: string | null) => void} [write] puts a key into the address
   * @param {() => string} [page] the page that the address names
   */
  constructor(write = remember, page = () => location.hash.split("?")[0]) {
    this.#remember = write;
    this.#page = page;
    this.#first = page();
  }

  /** @param {Record<string, string | null>} parts null takes a key away */
  write(parts) {
    if (this.#closed || Object.keys(parts).length === 0) return;
    Object.assign(this.#waiting, parts);
    if (this.#timer === undefined) this.#flush();
  }

  /** Leaves the address alone from now on: it may be another page's. */
  close() {
    this.#closed = true;
    clearTimeout(this.#timer);
  }

  #flush() {
    const parts = this.#waiting;
    this.#waiting = {};
    this.#timer = undefined;
    if (Object.keys(parts).length === 0 || this.#page() !== this.#first) return;
    for (const [key, value] of Object.entries(parts)) this.#remember(key, value);
    this.#timer = setTimeout(() => this.#flush(), PACE);
  }
}
