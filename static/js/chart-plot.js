// @ts-check
/**
 * A figure drawn by plotly.js, with the time cursor as a line over it.
 *
 * Emits `zoom` {from, to} (null: everything) and `seek` {time} on a time axis, `point` {x, y, z,
 * customdata, curve} on any other, where a zoom stays the chart's own affair.
 */
import { themed } from "./chart-theme.js";
import { h } from "./dom.js";

/** @typedef {import("./types.js").Figure} Figure */
/** @typedef {import("./chart-theme.js").Theme} Theme */

const CONFIG = { displayModeBar: false, responsive: true, doubleClick: false, scrollZoom: false };

export class ChartPlot extends EventTarget {
  #plot = /** @type {any} */ (h("div", { class: "plot" }));
  #line = h("div", { class: "cursor-line", hidden: true });
  #time = Number.NaN;
  /** Whether the horizontal axis is the time of the run. */
  #timed = true;
  /** @type {any} */
  #library = null;
  /** The horizontal and vertical range before anybody zoomed, off the time axis. @type {any} */
  #whole = {};
  element = h("div", { class: "plot-frame" }, this.#plot, this.#line);

  /** The time of the cursor. @param {number} time */
  set time(time) {
    this.#time = time;
    this.#placeLine();
  }

  /**
   * @param {any} library plotly.js
   * @param {Figure} figure
   * @param {Theme} theme
   * @param {{ narrow: boolean, view: string }} options `view` names the part that is shown: what
   *   somebody did to the axes is kept while it stays the same
   */
  async draw(library, figure, theme, { narrow, view }) {
    this.#library = library;
    this.#timed = isTimed(figure);
    const { data, layout } = themed(figure, theme, narrow);
    layout.uirevision = view;
    this.#whole = { xaxis: layout.xaxis.range, yaxis: layout.yaxis.range };
    const fresh = !this.#plot.on;
    await library.react(this.#plot, data, layout, CONFIG);
    if (fresh) this.#listen();
    this.#placeLine();
  }

  /** Frees what plotly.js holds. */
  purge() {
    this.#library?.purge(this.#plot);
  }

  #listen() {
    this.#plot.on("plotly_relayout", (/** @type {any} */ change) => {
      const from = change["xaxis.range[0]"];
      const to = change["xaxis.range[1]"];
      if (!this.#timed || from === undefined || to === undefined) return;
      this.#emit("zoom", { from: Math.max(0, Number(from)), to: Number(to) });
    });
    this.#plot.on("plotly_doubleclick", () => {
      if (this.#timed) this.#emit("zoom", null);
      else void this.#library.relayout(this.#plot, wholeAxes(this.#whole));
    });
    this.#plot.on("plotly_click", (/** @type {any} */ event) => {
      const [{ x, y, z, customdata, data }] = event.points;
      if (this.#timed) this.#emit("seek", { time: x });
      else this.#emit("point", { x, y, z, customdata, curve: data?.name });
    });
    this.#plot.on("plotly_afterplot", () => this.#placeLine());
  }

  /**
   * @param {string} name
   * @param {any} detail
   */
  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /** A line over the chart: moving it costs nothing, redrawing a chart would. */
  #placeLine() {
    const axis = this.#plot._fullLayout?.xaxis;
    const area = this.#plot._fullLayout?._size;
    const inside = this.#timed && axis && this.#time >= axis.range[0] && this.#time <= axis.range[1];
    this.#line.hidden = !inside;
    if (!inside) return;
    this.#line.style.transform = `translateX(${area.l + axis.d2p(this.#time)}px)`;
    this.#line.style.top = `${area.t}px`;
    this.#line.style.height = `${area.h}px`;
  }
}

/** Whether a figure is drawn over the time of its run. @param {Figure} figure */
export function isTimed(figure) {
  return /^time\b/.test(figure.layout.xaxis?.title?.text ?? "");
}

/**
 * What plotly.js needs to hear for axes to show everything again.
 *
 * @param {{ xaxis?: number[], yaxis?: number[] }} whole
 */
function wholeAxes(whole) {
  return Object.fromEntries(
    /** @type {const} */ (["xaxis", "yaxis"]).map((axis) =>
      whole[axis] ? [`${axis}.range`, [...(whole[axis] ?? [])]] : [`${axis}.autorange`, true],
    ),
  );
}
