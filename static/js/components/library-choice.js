// @ts-check
/** Takes a train, viaduct, track or irregularity from the library. Emits `edit` with the part. */
import { api } from "../api.js";
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").LibraryItem} Item */

/** The library's kind behind each section of the form. @type {Record<string, string>} */
const KINDS = { viaduct: "viaducts", train: "trains", track: "tracks", irregularities: "irregularities" };

/** Asked once a kind while the page lives; a library that is not there is an empty one. @type {Map<string, Promise<Item[]>>} */
const known = new Map();

/** @param {string} section */
export const libraryKind = (section) => KINDS[section] ?? null;

/** Forgets what was read, so that the next study shows what the library holds by then. */
export function forgetLibrary() {
  known.clear();
}

/** @param {string} kind */
function itemsOf(kind) {
  const items = known.get(kind) ?? api.library(kind).then(({ items }) => items, () => []);
  known.set(kind, items);
  return items;
}

export class LibraryChoice extends HTMLElement {
  /**
   * @param {string} kind
   * @param {string} title of the section
   * @param {string} pointer of the part that is replaced
   */
  bind(kind, title, pointer) {
    void itemsOf(kind).then((items) => items.length && this.#draw(items, title, pointer));
  }

  /**
   * @param {Item[]} items
   * @param {string} title
   * @param {string} pointer
   */
  #draw(items, title, pointer) {
    const group = /** @param {boolean} own */ (own) => items.filter((item) => item.built_in !== own);
    const options = /** @param {Item[]} some */ (some) => some.map((item) => h("option", { value: item.id }, item.name));
    const select = h(
      "select",
      { "aria-label": `${title} from the library`, onchange: () => this.#choose(items.find((item) => item.id === select.value), pointer) },
      h("option", { value: "" }, "From the library…"),
      group(true).length > 0 && h("optgroup", { label: "Yours" }, options(group(true))),
      h("optgroup", { label: "Built in" }, options(group(false))),
    );
    show(this, select);
  }

  /**
   * @param {Item | undefined} item
   * @param {string} pointer
   */
  #choose(item, pointer) {
    if (!item) return;
    this.dispatchEvent(new CustomEvent("edit", { detail: { pointer, value: item.value, whole: true }, bubbles: true }));
  }
}

customElements.define("tb-library-choice", LibraryChoice);
