// @ts-check
/** The entries of the library as cards; export and import. Emits `imported`. */
import { api, ApiError, libraryUrl } from "../api.js";
import { h, show } from "../dom.js";
import { KINDS, importable } from "../library-parts.js";
import { link } from "../router.js";
import { sentence } from "./finding-lines.js";

/** @typedef {import("../types.js").LibraryItem} Item */

/** As large as the server takes. [B] */
const LARGEST = 4 * 1024 * 1024;

export class LibraryList extends HTMLElement {
  #said = h("div", { class: "library-said", role: "status" });
  #file = h("input", { type: "file", accept: "application/json,.json", class: "sr", id: "library-file", tabindex: "-1", "aria-label": "File to import", onchange: () => void this.#import() });

  /**
   * @param {Item[]} items
   * @param {string} kind empty for all
   */
  bind(items, kind) {
    const kinds = KINDS.filter((entry) => !kind || entry.kind === kind);
    show(
      this,
      h("div", { class: "row spread library-head" }, h("h1", null, "Library"), this.#actions(kind)),
      h("p", { class: "soft lead" }, "Trains, viaducts, tracks and irregularities to build studies from. A study takes a copy: changing an entry never changes a job."),
      this.#said,
      h("nav", { class: "library-kinds", "aria-label": "Kinds" }, this.#tab("", "All", kind), KINDS.map((entry) => this.#tab(entry.kind, entry.title, kind))),
      kinds.map((entry) => section(entry, items.filter((item) => item.kind === entry.kind))),
    );
  }

  /**
   * @param {string} kind
   * @param {string} title
   * @param {string} shown
   */
  #tab(kind, title, shown) {
    return h("a", { href: kind ? link("library", kind) : link("library"), "aria-current": kind === shown ? "page" : null }, title);
  }

  /** @param {string} kind */
  #actions(kind) {
    return h(
      "div",
      { class: "row" },
      h("button", { type: "button", onclick: () => this.#file.click() }, "Import JSON"),
      this.#file,
      h("a", { class: "button", href: libraryUrl(kind || undefined), download: `trainbridge-library${kind ? `-${kind}` : ""}.json` }, "Export JSON"),
    );
  }

  async #import() {
    const file = this.#file.files?.[0];
    if (!file) return;
    try {
      if (file.size > LARGEST) throw new Error(`The file has ${(file.size / 1048576).toFixed(1)} MiB; at most 4 MiB can be imported.`);
      const { items, skipped } = await api.importLibrary(importable(await file.text()));
      const were = skipped.length ? ` Here already, left as they are: ${skipped.join(", ")}.` : "";
      const words = items.length ? `Imported: ${items.map((item) => item.name).join(", ")}.` : "Nothing new.";
      this.dispatchEvent(new CustomEvent("imported", { detail: `${words}${were}` }));
    } catch (error) {
      this.#complain(file.name, /** @type {Error} */ (error));
    } finally {
      this.#file.value = "";
    }
  }

  /** What became of an import. @param {string} words */
  set said(words) {
    show(this.#said, h("div", { class: "notice" }, h("p", null, words)));
  }

  /**
   * @param {string} name
   * @param {Error} error
   */
  #complain(name, error) {
    const findings = error instanceof ApiError ? error.findings : [];
    show(
      this.#said,
      h(
        "div",
        { class: "notice bad", role: "alert" },
        h(
          "div",
          null,
          h("p", null, h("strong", null, `${name} was not imported.`)),
          findings.length ? h("ul", null, findings.map((item) => h("li", null, sentence(item), " ", h("span", { class: "mono" }, item.pointer)))) : h("p", null, error.message),
        ),
      ),
    );
  }
}

/**
 * @param {{ kind: string, title: string }} entry
 * @param {Item[]} items
 */
function section({ kind, title }, items) {
  return h(
    "section",
    { "aria-label": title },
    h("h2", { class: "section-head" }, title),
    h("ul", { class: "library-cards" }, items.map((item) => h("li", null, card(kind, item)))),
  );
}

/**
 * @param {string} kind
 * @param {Item} item
 */
function card(kind, item) {
  const assumed = item.remarks.length;
  return h(
    "a",
    { class: "card library-card", href: link("library", kind, item.id) },
    h("span", { class: "library-name" }, item.name),
    h("span", { class: "soft small" }, item.source || "No source given."),
    h(
      "span",
      { class: "row library-marks" },
      h("span", { class: item.built_in ? "tag" : "tag running" }, item.built_in ? "Built in" : "Yours"),
      assumed > 0 && h("span", { class: "tag queued" }, `${assumed} remark${assumed > 1 ? "s" : ""}`),
    ),
  );
}

customElements.define("tb-library-list", LibraryList);
