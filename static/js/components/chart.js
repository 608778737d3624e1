// @ts-check
/**
 * One figure of a run: curves, time cursor, words, numbers, files.
 *
 * Emits `zoom` {from, to} (null for the whole run) and `seek` {time}; refetches itself when its
 * window changes, so that a zoom shows every sample.
 */
import { CurvePicker } from "./curve-picker.js";
import { extremesTable } from "./extremes-table.js";
import { api, figureUrl } from "../api.js";
import { chartLibrary } from "../chart-library.js";
import { themed } from "../chart-theme.js";
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").Figure} Figure */
/** @typedef {{ from: number, to: number } | null} TimeWindow */

const NARROW = 560;
const CONFIG = { displayModeBar: false, responsive: true, doubleClick: false, scrollZoom: false };

export class Chart extends HTMLElement {
  #run = "";
  #name = "";
  #library = "";
  /** @type {TimeWindow} */
  #window = null;
  /** @type {Figure | null} */
  #figure = null;
  /** @type {AbortController | null} */
  #fetching = null;
  #plot = /** @type {any} */ (h("div", { class: "plot" }));
  #line = h("div", { class: "cursor-line", hidden: true });
  #heading = h("h3");
  #summary = h("p", { class: "soft small summary" });
  #table = h("div", { class: "scroll" });
  #picker = /** @type {CurvePicker} */ (h("tb-curve-picker"));
  /** @type {string[]} channels somebody chose; empty for the figure's own choice */
  #channels = [];
  #files = h("div", { class: "row files" });
  #time = Number.NaN;
  #scheme = matchMedia("(prefers-color-scheme: dark)");
  #redraw = () => void this.#draw();

  /**
   * @param {{ run: string, name: string, title: string, library: string, window: TimeWindow }} options
   */
  bind({ run, name, title, library, window }) {
    this.#run = run;
    this.#name = name;
    this.#library = library;
    this.#window = window;
    this.classList.add("card", "chart");
    this.dataset.figure = name;
    show(this.#heading, title);
    show(
      this,
      h("div", { class: "row spread" }, this.#heading, this.#files),
      h("div", { class: "plot-frame" }, this.#plot, this.#line),
      this.#summary,
      h(
        "details",
        { ontoggle: () => void this.#picker.load() },
        h("summary", null, "Numbers and curves"),
        this.#picker,
        this.#table,
      ),
    );
    this.#picker.addEventListener("curves", (event) => {
      this.#channels = /** @type {CustomEvent} */ (event).detail;
      void this.refresh();
    });
    this.#scheme.addEventListener("change", this.#redraw);
  }

  disconnectedCallback() {
    this.#fetching?.abort();
    this.#scheme.removeEventListener("change", this.#redraw);
    /** @type {any} */ (window).Plotly?.purge(this.#plot);
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

  /** The time of the cursor. @param {number} time */
  set time(time) {
    this.#time = time;
    this.#placeLine();
  }

  /** Fetches and draws again; a newer call ends an older one. */
  async refresh() {
    this.#fetching?.abort();
    const fetching = new AbortController();
    this.#fetching = fetching;
    const window = this.#window;
    try {
      const points = Math.min(4000, Math.max(600, Math.round(this.clientWidth * 2)));
      const figure = await api.figure(this.#run, this.#name, { ...window, points, channels: this.#channels }, fetching.signal);
      this.#figure = figure;
      this.dispatchEvent(new CustomEvent("figure", { detail: figure }));
      await this.#draw();
    } catch (error) {
      if (fetching.signal.aborted) return;
      const status = /** @type {any} */ (error).status;
      show(this.#summary, status === 404 || status === 409 ? "The first curves appear with the first steps." : String(/** @type {Error} */ (error).message));
    }
  }

  async #draw() {
    const figure = this.#figure;
    if (!figure) return;
    const library = await chartLibrary(this.#library);
    if (!this.isConnected) return;
    const { data, layout } = themed(figure, theme(this.#scheme.matches), this.clientWidth < NARROW);
    layout.uirevision = JSON.stringify(this.#window);
    const fresh = !this.#plot.on;
    await library.react(this.#plot, data, layout, CONFIG);
    if (fresh) this.#listen();
    this.#placeLine();
    this.#describe(figure);
  }

  #listen() {
    this.#plot.on("plotly_relayout", (/** @type {any} */ change) => {
      const from = change["xaxis.range[0]"];
      const to = change["xaxis.range[1]"];
      if (from === undefined || to === undefined) return;
      this.#emit("zoom", { from: Math.max(0, Number(from)), to: Number(to) });
    });
    this.#plot.on("plotly_doubleclick", () => this.#emit("zoom", null));
    this.#plot.on("plotly_click", (/** @type {any} */ event) => {
      this.#emit("seek", { time: event.points[0].x });
    });
    this.#plot.on("plotly_afterplot", () => this.#placeLine());
  }

  /**
   * @param {string} name
   * @param {any} detail
   */
  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail, bubbles: true }));
  }

  /** A line over the chart: moving it costs nothing, redrawing a chart would. */
  #placeLine() {
    const axis = this.#plot._fullLayout?.xaxis;
    const area = this.#plot._fullLayout?._size;
    const inside = axis && this.#time >= axis.range[0] && this.#time <= axis.range[1];
    this.#line.hidden = !inside;
    if (!inside) return;
    this.#line.style.transform = `translateX(${area.l + axis.d2p(this.#time)}px)`;
    this.#line.style.top = `${area.t}px`;
    this.#line.style.height = `${area.h}px`;
  }

  /** @param {Figure} figure */
  #describe(figure) {
    if (figure.layout.title?.text) show(this.#heading, plain(figure.layout.title.text));
    show(this.#summary, figure.summary);
    const query = { ...this.#window, channels: this.#channels };
    this.#picker.bind(this.#run, [...new Set(figure.table.map((row) => row.channel).filter(Boolean))]);
    show(
      this.#files,
      /** @type {const} */ (["png", "svg", "pdf"]).map((format) =>
        h("a", { href: figureUrl(this.#run, this.#name, format, query), download: "" }, format.toUpperCase()),
      ),
    );
    show(this.#table, extremesTable(figure, this.#run));
  }
}

/** Text that the server escaped for plotly, which reads a kind of HTML. @param {string} text */
const plain = (text) => text.replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&amp;", "&");

/**
 * @param {boolean} dark
 * @returns {import("../chart-theme.js").Theme}
 */
function theme(dark) {
  const style = getComputedStyle(document.documentElement);
  const read = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  return { dark, ink: read("--ink"), soft: read("--ink-soft"), line: read("--line"), paper: read("--card"), type: read("--type") };
}

customElements.define("tb-chart", Chart);
