// @ts-check
/** 3D view above stacked plots, one time cursor for all; the address remembers window and time. */
import { Chart } from "./chart.js";
import { TimeBar } from "./time-bar.js";
import { ViewerFrame } from "./viewer-frame.js";
import { h, show } from "../dom.js";
import { remember } from "../router.js";
import { pleasingScale } from "../scale.js";
import { store } from "../store.js";
import { TimeCursor } from "../time-cursor.js";

/** @typedef {import("./chart.js").TimeWindow} TimeWindow */

const FIGURES = [
  ["slab-acceleration", "Vertical acceleration"],
  ["contact-force", "Contact force"],
  ["displacement", "Displacement"],
];
/** Live curves are fetched again at most this often. [ms] */
const PACE = 1500;

export class RunInstrument extends HTMLElement {
  #cursor = new TimeCursor();
  #ended = new AbortController();
  /** @type {Chart[]} */
  #charts = [];
  #viewer = /** @type {ViewerFrame} */ (h("tb-viewer-frame"));
  #whole = h("button", { type: "button", class: "quiet", hidden: true, onclick: () => this.#zoom(null) }, "Whole run");
  #state = "";
  /** The cursor goes where the computation is, until somebody takes it. */
  #following = true;
  /** @type {number | null} */
  #suggested = null;
  #drawnAt = 0;
  #refreshing = false;

  /** @param {{ run: string, query: URLSearchParams }} options */
  async bind({ run, query }) {
    const meta = await store.get("meta");
    const bar = /** @type {TimeBar} */ (h("tb-time-bar"));
    bar.cursor = this.#cursor;
    const window = windowOf(query);
    this.#whole.hidden = window === null;
    this.#charts = FIGURES.map(([name, title]) => {
      const chart = /** @type {Chart} */ (h("tb-chart"));
      chart.bind({ run, name, title, library: meta.plotly_url, window });
      return chart;
    });
    this.#viewer.bind({ run, cursor: this.#cursor, fallback: h("div", { class: "viewer-wait" }, h("p", { class: "soft" }, "The 3D view opens with the first steps.")) });
    show(this, this.#viewer, bar, h("div", { class: "row spread section-head" }, h("h2", null, "Histories"), this.#whole), this.#charts);
    this.#listen(query);
    await this.#refresh();
    this.#openViewer();
  }

  #openViewer() {
    void this.#viewer.start({ computing: this.#state === "running" });
  }

  /** Shows a time of interest, unless somebody has chosen another. @param {number} time */
  suggest(time) {
    this.#suggested = time;
    if (this.#following && this.#cursor.end > 0) this.#cursor.follow(time);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /**
   * How far the run is; live curves are fetched again, at a calm pace.
   *
   * @param {string} state
   * @param {number | null} time simulated time [s]
   */
  progress(state, time) {
    const ended = state !== this.#state && state !== "running";
    this.#state = state;
    if (!this.#charts.length) return;
    this.#openViewer();
    if (this.#following && time !== null && state === "running") this.#cursor.follow(time);
    if (ended || performance.now() - this.#drawnAt > PACE) void this.#refresh();
  }

  async #refresh() {
    if (this.#refreshing) return;
    this.#refreshing = true;
    const state = this.#state;
    await Promise.all(this.#charts.map((chart) => chart.refresh()));
    this.#drawnAt = performance.now();
    this.#refreshing = false;
    // The end came while older curves were on their way.
    if (state !== this.#state) void this.#refresh();
  }

  /** @param {URLSearchParams} query */
  #listen(query) {
    const signal = this.#ended.signal;
    const asked = Number(query.get("t") ?? Number.NaN);
    this.#following = !Number.isFinite(asked);
    this.#charts[0].addEventListener(
      "figure",
      (event) => {
        const { end, window_start: first } = /** @type {CustomEvent} */ (event).detail.layout.meta;
        if (this.#cursor.end === end) return;
        this.#cursor.setRange(0, end);
        this.#cursor.follow(Number.isFinite(asked) ? asked : (this.#suggested ?? first));
      },
      { signal },
    );
    this.#charts[2].addEventListener(
      "figure",
      (event) => this.#viewer.propose(pleasingScale(/** @type {CustomEvent} */ (event).detail.table)),
      { signal },
    );
    this.addEventListener("zoom", (event) => this.#zoom(/** @type {CustomEvent} */ (event).detail), { signal });
    this.addEventListener("seek", (event) => this.#cursor.seek(/** @type {CustomEvent} */ (event).detail.time), { signal });
    this.#cursor.addEventListener("change", (event) => this.#move(/** @type {CustomEvent} */ (event).detail), { signal });
    addEventListener("keydown", (event) => this.#key(event), { signal });
  }

  /** @param {import("../time-cursor.js").CursorState & { reason: string }} state */
  #move({ time, reason }) {
    for (const chart of this.#charts) chart.time = time;
    if (reason === "seek" || reason === "play") this.#following = false;
    if (reason === "seek" || reason === "pause") remember("t", time.toFixed(4));
    if (reason === "play") requestAnimationFrame((now) => this.#tick(now));
  }

  /** @param {number} now */
  #tick(now) {
    if (!this.#cursor.playing || this.#ended.signal.aborted) return;
    this.#cursor.tick(now);
    requestAnimationFrame((next) => this.#tick(next));
  }

  /** @param {TimeWindow} window */
  #zoom(window) {
    for (const chart of this.#charts) chart.window = window;
    this.#whole.hidden = window === null;
    remember("from", window && window.from.toFixed(4));
    remember("to", window && window.to.toFixed(4));
  }

  /** Space plays and pauses, unless a control wants it. @param {KeyboardEvent} event */
  #key(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.code !== "Space" || target.closest("button, a, input, select, summary")) return;
    event.preventDefault();
    this.#cursor.toggle();
  }
}

/**
 * The window that an address asks for.
 *
 * @param {URLSearchParams} query
 * @returns {TimeWindow}
 */
function windowOf(query) {
  const from = Number(query.get("from") ?? Number.NaN);
  const to = Number(query.get("to") ?? Number.NaN);
  return from < to ? { from, to } : null;
}

customElements.define("tb-run-instrument", RunInstrument);
