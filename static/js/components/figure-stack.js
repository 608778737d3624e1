// @ts-check
/**
 * Charts one above the other that share the page's time, zoom and place. Fetches only while it is
 * shown. Emits `figure` {name, figure} for each that arrives.
 */
import { Chart } from "./chart.js";
import { h, show } from "../dom.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../types.js").FigureItem} FigureItem */
/** @typedef {import("../types.js").FigureSource} FigureSource */

export class FigureStack extends HTMLElement {
  /** @type {RunView | null} */
  #view = null;
  /** @type {Map<string, Chart>} */
  #charts = new Map();
  /** Figures that are of one place. @type {Set<string>} */
  #placed = new Set();
  #ended = new AbortController();
  #shown = false;
  #stale = true;

  /**
   * @param {{ view: RunView, library: string, figures: FigureItem[],
   *   source: (name: string) => FigureSource, empty?: string }} options
   */
  bind({ view, library, figures, source, empty }) {
    this.#view = view;
    this.classList.add("figure-stack");
    for (const item of figures) {
      const { name, title } = item;
      if (item.needs_place) this.#placed.add(name);
      const chart = /** @type {Chart} */ (h("tb-chart"));
      const variants = (item.variants ?? []).map((variant) => /** @type {[string, string]} */ ([variant.name, variant.title]));
      const any = item.axis === "frequency";
      chart.bind({ source: source(name), title, library, window: view.look.window, query: this.#query(name), variants, any, empty });
      chart.addEventListener("curves", (event) => this.#keep(name, /** @type {CustomEvent} */ (event).detail.channels));
      chart.addEventListener("variant", (event) => view.set({ variants: { ...view.look.variants, [name]: /** @type {CustomEvent} */ (event).detail.variant } }));
      chart.addEventListener("point", (event) => this.#point(name, /** @type {CustomEvent} */ (event).detail));
      this.#charts.set(name, chart);
    }
    show(this, [...this.#charts.values()]);
    this.#listen(view);
  }

  /** @param {RunView} view */
  #listen(view) {
    const signal = this.#ended.signal;
    this.addEventListener("zoom", (event) => view.set({ window: /** @type {CustomEvent} */ (event).detail }));
    this.addEventListener("seek", (event) => view.cursor.seek(/** @type {CustomEvent} */ (event).detail.time));
    view.cursor.addEventListener("change", () => this.#place(), { signal });
    view.watch(["window"], ({ window }) => this.#each((chart) => (chart.window = window)), signal);
    view.watch(
      ["place"],
      () => this.#each((chart, name) => this.#placed.has(name) && (chart.query = this.#query(name))),
      signal,
    );
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** Whether somebody can see it. @param {boolean} shown */
  set shown(shown) {
    this.#shown = shown;
    if (shown && this.#stale) void this.refresh();
    this.#place();
  }

  /** Fetches every figure again, once it is seen. */
  async refresh() {
    this.#stale = !this.#shown;
    if (this.#stale || !this.#view) return;
    const { window } = this.#view.look;
    for (const [name, chart] of this.#charts) chart.prepare({ window, query: this.#query(name) });
    await Promise.all(
      [...this.#charts].map(async ([name, chart]) => {
        await chart.refresh();
        if (chart.figure) this.dispatchEvent(new CustomEvent("figure", { detail: { name, figure: chart.figure } }));
      }),
    );
    this.#place();
  }

  #place() {
    if (!this.#shown || !this.#view) return;
    for (const chart of this.#charts.values()) chart.time = this.#view.cursor.time;
  }

  /**
   * A change of what is asked for; what is not seen waits.
   *
   * @param {(chart: Chart, name: string) => void} change
   */
  #each(change) {
    this.#stale ||= !this.#shown;
    if (this.#shown) for (const [name, chart] of this.#charts) change(chart, name);
  }

  /**
   * @param {string} name
   * @returns {import("../types.js").FigureQuery}
   */
  #query(name) {
    const look = /** @type {RunView} */ (this.#view).look;
    const place = this.#placed.has(name) && look.place ? look.place.join(",") : undefined;
    return { channels: look.channels[name], place, variant: look.variants[name] };
  }

  /**
   * @param {string} name
   * @param {string[]} channels
   */
  #keep(name, channels) {
    const view = /** @type {RunView} */ (this.#view);
    view.set({ channels: { ...view.look.channels, [name]: channels } });
  }

  /**
   * A mark that was pressed: a place on the map, a run of the sweep.
   *
   * @param {string} name
   * @param {{ x: number, y: number, customdata?: any }} mark
   */
  #point(name, { x, y, customdata }) {
    const view = /** @type {RunView} */ (this.#view);
    if (name === "slab-map") view.set({ place: [x, y, view.slabLevel] });
    const run = Array.isArray(customdata) ? customdata[0] : customdata;
    if (name === "speed-sweep" && typeof run === "string") view.set({ run });
  }
}

customElements.define("tb-figure-stack", FigureStack);
