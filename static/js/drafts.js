// @ts-check
/** Changes that outlive the page, in the browser's storage; the oldest give way. */

/** @typedef {{ value: any, saved: number }} Draft a study or an entry of the library, and when it was kept [ms] */

const KEY = "trainbridge.drafts";
/** Drafts that are kept at most. */
const MOST = 12;
/** Room for all of them together; browsers grant about five million. [characters] */
const ROOM = 1_000_000;

export class Drafts {
  /** @param {() => Pick<Storage, "getItem" | "setItem">} storage a browser may refuse to give it */
  constructor(storage = () => localStorage) {
    this.storage = storage;
  }

  /**
   * @param {string} source where it came from: a template, a job, an entry of the library
   * @returns {Draft | null}
   */
  get(source) {
    return this.#all().find(([name]) => name === source)?.[1] ?? null;
  }

  /**
   * @param {string} source
   * @param {Draft | null} draft null forgets it
   */
  keep(source, draft) {
    const others = this.#all().filter(([name]) => name !== source);
    const kept = (draft ? [/** @type {[string, Draft]} */ ([source, draft]), ...others] : others).slice(0, MOST);
    while (JSON.stringify(kept).length > ROOM) kept.pop();
    try {
      this.storage().setItem(KEY, JSON.stringify(kept));
    } catch {
      // A full or forbidden storage: the page works on without drafts.
    }
  }

  /** Newest first. @returns {[string, Draft][]} */
  #all() {
    try {
      const stored = JSON.parse(this.storage().getItem(KEY) ?? "[]");
      return Array.isArray(stored) ? stored.filter((item) => Array.isArray(item) && item[1]?.value) : [];
    } catch {
      return [];
    }
  }
}
