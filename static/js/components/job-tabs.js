// @ts-check
/**
 * Tabs and the panels they show, as WAI-ARIA describes them: arrows, Home and End move. A panel is
 * built when it is first shown. Emits `tab` {id}.
 */
import { h, show } from "../dom.js";

/** @typedef {{ id: string, title: string }} TabTitle */

/** @type {Record<string, (index: number, count: number) => number>} */
const MOVES = {
  ArrowRight: (index, count) => (index + 1) % count,
  ArrowLeft: (index, count) => (index + count - 1) % count,
  Home: () => 0,
  End: (_, count) => count - 1,
};

export class JobTabs extends HTMLElement {
  /** @type {readonly TabTitle[]} */
  #tabs = [];
  #chosen = "";
  /** @type {(id: string) => HTMLElement} */
  #build = () => h("div");
  /** @type {Map<string, HTMLElement>} */
  #panels = new Map();
  #list = h("div", { role: "tablist", "aria-label": "Parts of the job" });
  #place = h("div");

  /**
   * @param {{ tabs: readonly TabTitle[], chosen: string, build: (id: string) => HTMLElement }} options
   *   `build` makes a panel's content
   */
  bind({ tabs, chosen, build }) {
    this.#build = build;
    this.#panels.clear();
    this.#list.onkeydown = (event) => this.#key(event);
    show(this.#place);
    show(this, this.#list, this.#place);
    this.#chosen = "";
    this.tabs = tabs;
    this.choose(chosen);
  }

  /** The tabs there are, as more becomes known. @param {readonly TabTitle[]} tabs */
  set tabs(tabs) {
    if (JSON.stringify(tabs) === JSON.stringify(this.#tabs)) return;
    this.#tabs = tabs;
    const focused = this.#list.contains(document.activeElement);
    show(this.#list, tabs.map((tab) => this.#tab(tab)));
    if (this.#chosen) this.choose(this.#chosen);
    if (focused) this.#button(this.#chosen)?.focus();
  }

  /** @returns {string} */
  get chosen() {
    return this.#chosen;
  }

  /** What a panel holds, where it has been built. @param {string} id */
  panel(id) {
    return this.#panels.get(id)?.firstElementChild ?? null;
  }

  /** Builds a panel again when it is next shown. @param {string} id */
  forget(id) {
    this.#panels.get(id)?.remove();
    this.#panels.delete(id);
    if (id === this.#chosen) this.#open(id);
  }

  /** @param {string} id the first tab where there is no such */
  choose(id) {
    const tab = this.#tabs.find((item) => item.id === id) ?? this.#tabs[0];
    if (!tab) return;
    this.#chosen = tab.id;
    for (const button of /** @type {NodeListOf<HTMLElement>} */ (this.#list.querySelectorAll("[role=tab]"))) {
      const chosen = button.dataset.tab === tab.id;
      button.setAttribute("aria-selected", String(chosen));
      button.tabIndex = chosen ? 0 : -1;
    }
    this.#open(tab.id);
  }

  /** @param {string} id */
  #open(id) {
    if (!this.#panels.has(id)) {
      const panel = h("div", { role: "tabpanel", id: `panel-${id}`, "aria-labelledby": `tab-${id}`, tabindex: 0 }, this.#build(id));
      this.#panels.set(id, panel);
      this.#place.append(panel);
    }
    for (const [name, panel] of this.#panels) panel.hidden = name !== id;
  }

  /** @param {TabTitle} tab */
  #tab({ id, title }) {
    const chosen = id === this.#chosen;
    const choose = () => this.#say(id);
    return h(
      "button",
      { type: "button", role: "tab", id: `tab-${id}`, "aria-controls": `panel-${id}`, "aria-selected": String(chosen), tabindex: chosen ? 0 : -1, data: { tab: id }, onclick: choose },
      title,
    );
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const move = MOVES[event.key];
    if (!move) return;
    event.preventDefault();
    const index = this.#tabs.findIndex((tab) => tab.id === this.#chosen);
    this.#say(this.#tabs[move(index, this.#tabs.length)].id);
    this.#button(this.#chosen)?.focus();
  }

  /** @param {string} id */
  #say(id) {
    this.choose(id);
    this.dispatchEvent(new CustomEvent("tab", { detail: { id } }));
  }

  /** @param {string} id */
  #button(id) {
    return /** @type {HTMLElement | null} */ (this.#list.querySelector(`[data-tab="${id}"]`));
  }
}

customElements.define("tb-job-tabs", JobTabs);
