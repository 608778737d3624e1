// @ts-check
/**
 * One figure: curves, time cursor, words, numbers, files of what is visible.
 *
 * Emits `zoom` {from, to} (null for everything), `seek` {time}, `point` {x, y, customdata} off the
 * time axis, `curves` {channels} and `variant` {variant}; refetches itself when its window changes,
 * so that a zoom shows every sample.
 */
import { CurvePicker } from "./curve-picker.js";
import { figureTable } from "./figure-table.js";
import { segments } from "./segments.js";
import { chartLibrary } from "../chart-library.js";
import { ChartPlot, isTimed } from "../chart-plot.js";
import { h, show } from "../dom.js";
import { pageColours } from "../page-colours.js";
import { store } from "../store.js";
import { currentTheme } from "../theme.js";

/** @typedef {import("../types.js").Figure} Figure */
/** @typedef {import("../types.js").FigureSource} FigureSource */
/** @typedef {import("../types.js").FigureQuery} FigureQuery */
/** @typedef {{ from: number, to: number } | null} TimeWindow */
/**
 * @typedef {{ source: FigureSource, title: string, library: string, window?: TimeWindow,
 *   query?: FigureQuery, variants?: [string, string][], any?: boolean, empty?: string }} ChartOptions
 *   `query` is asked for besides the window; `variants` can be switched between: value and title;
 *   `any`: curves of any quantity can be drawn together; `empty` is said while there is no figure
 */

const NARROW = 560;
const FILES = /** @type {const} */ (["csv", "png", "svg", "pdf"]);

export class Chart extends HTMLElement {
  /** @type {FigureSource | null} */
  #source = null;
  #library = "";
  #empty = "";
  /** @type {TimeWindow} */
  #window = null;
  /** @type {FigureQuery} */
  #query = {};
  /** @type {Figure | null} */
  #figure = null;
  /** @type {AbortController | null} */
  #fetching = null;
  #ended = new AbortController();
  #plot = new ChartPlot();
  #heading = h("h3");
  #summary = h("p", { class: "soft small summary" });
  #more = h("summary", null, "Numbers");
  #table = h("div", { class: "scroll", tabindex: 0, role: "region" });
  #picker = /** @type {CurvePicker} */ (h("tb-curve-picker"));
  #files = h("div", { class: "row files", role: "group", "aria-label": "Save what is visible" });

  /** @param {ChartOptions} options */
  bind({ source, title, library, window = null, query = {}, variants = [], any = false, empty = "" }) {
    this.#source = source;
    this.#library = library;
    this.#window = window;
    this.#query = query;
    this.#empty = empty || "The first curves appear with the first steps.";
    this.classList.add("card", "chart");
    this.dataset.figure = source.name;
    show(this.#heading, title);
    this.#table.setAttribute("aria-label", `Numbers: ${title}`);
    show(this.#summary, "On its way…");
    if (source.channels) this.#picker.bind({ load: source.channels, any, drawn: [] });
    const tools = h("div", { class: "row chart-tools" }, variants.length > 1 && segments({ legend: title, options: variants, chosen: query.variant ?? variants[0][0], choose: (variant) => this.#vary(variant) }), this.#files);
    show(
      this,
      h("div", { class: "row spread" }, this.#heading, tools),
      this.#plot.element,
      this.#summary,
      h("details", { ontoggle: () => void this.#picker.load() }, this.#more, this.#picker, this.#table),
    );
    this.#listen();
  }

  #listen() {
    const signal = this.#ended.signal;
    for (const name of ["zoom", "seek", "point"]) {
      this.#plot.addEventListener(name, (event) => this.#emit(name, /** @type {CustomEvent} */ (event).detail), { signal });
    }
    this.#picker.addEventListener("curves", (event) => {
      const channels = /** @type {CustomEvent} */ (event).detail;
      this.query = { channels };
      this.#emit("curves", { channels });
    });
    let theme = currentTheme();
    store.watch("theme", () => {
      if (theme !== currentTheme()) void this.refresh();
      theme = currentTheme();
    }, signal);
  }

  disconnectedCallback() {
    this.#fetching?.abort();
    this.#ended.abort();
    this.#plot.purge();
  }

  /** @returns {Figure | null} */
  get figure() {
    return this.#figure;
  }

  /** @param {TimeWindow} window */
  set window(window) {
    this.#window = window;
    void this.refresh();
  }

  /** Asks for other channels, another place, another variant; the rest stays. @param {FigureQuery} change */
  set query(change) {
    this.#query = { ...this.#query, ...change };
    void this.refresh();
  }

  /** What the next refresh asks for. @param {{ window: TimeWindow, query: FigureQuery }} asked */
  prepare({ window, query }) {
    this.#window = window;
    this.#query = { ...this.#query, ...query };
  }

  /** The time of the cursor. @param {number} time */
  set time(time) {
    this.#plot.time = time;
  }

  /** Fetches and draws again; a newer call ends an older one. */
  async refresh() {
    if (!this.#source) return;
    this.#fetching?.abort();
    const fetching = new AbortController();
    this.#fetching = fetching;
    try {
      const points = Math.min(4000, Math.max(600, Math.round(this.clientWidth * 2)));
      const figure = await this.#source.json({ ...this.#asked(), points }, fetching.signal);
      this.#figure = figure;
      this.dispatchEvent(new CustomEvent("figure", { detail: figure }));
      await this.#draw(figure);
    } catch (error) {
      if (fetching.signal.aborted) return;
      const status = /** @type {any} */ (error).status;
      show(this.#summary, status === 409 ? this.#empty : String(/** @type {Error} */ (error).message));
    }
  }

  /** @returns {FigureQuery} */
  #asked() {
    return { ...this.#query, ...this.#window, theme: currentTheme() };
  }

  /** @param {Figure} figure */
  async #draw(figure) {
    const library = await chartLibrary(this.#library);
    if (!this.isConnected) return;
    const view = JSON.stringify(isTimed(figure) ? this.#window : this.#query);
    await this.#plot.draw(library, figure, pageColours(), { narrow: this.clientWidth < NARROW, view });
    this.#describe(figure);
  }

  /**
   * @param {string} name
   * @param {any} detail
   */
  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail, bubbles: true }));
  }

  /** @param {Figure} figure */
  #describe(figure) {
    const source = this.#source;
    if (!source) return;
    if (figure.layout.title?.text) show(this.#heading, plain(figure.layout.title.text));
    show(this.#summary, figure.summary);
    const drawn = [...new Set(figure.table.map((row) => row.channel).filter(Boolean))];
    this.#picker.drawn = drawn;
    // Curves can be chosen where the figure is made of channels.
    this.#picker.hidden = !source.channels || drawn.length === 0;
    show(this.#more, this.#picker.hidden ? "Numbers" : "Numbers and curves");
    const links = FILES.map((format) => h("a", { href: source.url(format, this.#asked()), download: "" }, format.toUpperCase()));
    show(this.#files, links);
    show(this.#table, figureTable(figure, source.channelUrl));
  }

  /** @param {string} variant one of several ways to draw the same figure */
  #vary(variant) {
    this.query = { variant };
    this.#emit("variant", { variant });
  }
}

/** Text that the server escaped for plotly, which reads a kind of HTML. @param {string} text */
const plain = (text) => text.replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&amp;", "&");

customElements.define("tb-chart", Chart);
