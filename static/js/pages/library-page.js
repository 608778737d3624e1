// @ts-check
/** The library: all entries, those of one kind, or one entry. */
import { LibraryEntry } from "../components/library-entry.js";
import { LibraryList } from "../components/library-list.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { kindOf } from "../library-parts.js";
import { link } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../router.js").Route} Route */

export class LibraryPage extends HTMLElement {
  /** @type {Route} */
  route = { name: "library", parts: [], query: new URLSearchParams() };

  connectedCallback() {
    show(this, h("div", { class: "skeleton" }));
    void this.#open();
  }

  async #open() {
    const [kind = "", id] = this.route.parts;
    try {
      if (kind && !kindOf(kind)) throw new Error(`The library holds no ${kind}.`);
      if (id) await this.#entry(kind, id);
      else await this.#list(kind);
    } catch (error) {
      show(
        this,
        h("div", { class: "notice bad", role: "alert" }, h("div", null, h("p", null, /** @type {Error} */ (error).message), h("p", null, h("a", { href: link("library") }, "Open the library")))),
      );
    }
  }

  /** @param {string} kind @param {string} [said] */
  async #list(kind, said) {
    const { items } = await api.wholeLibrary();
    if (!this.isConnected) return;
    document.title = `${kindOf(kind)?.title ?? "Library"} · Trainbridge`;
    const list = /** @type {LibraryList} */ (h("tb-library-list"));
    list.addEventListener("imported", (event) => void this.#list(kind, /** @type {CustomEvent} */ (event).detail));
    show(this, list);
    list.bind(items, kind);
    if (said) list.said = said;
  }

  /** @param {string} kind @param {string} id */
  async #entry(kind, id) {
    const meta = await store.get("meta");
    const [item, templates, schema] = await Promise.all([api.entry(kind, id), api.templates(), api.schema(meta.openapi_url ?? "/api/v1/openapi.json")]);
    if (!this.isConnected) return;
    const entry = /** @type {LibraryEntry} */ (h("tb-library-entry"));
    show(this, entry);
    entry.bind(item, { templates: templates.items, document: schema }, this.route.query.get("edit") === "1");
  }
}

customElements.define("tb-library-page", LibraryPage);
