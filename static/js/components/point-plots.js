// @ts-check
/** The histories of one point of the deck: where somebody pressed in the 3D view or on the map. */
import { FigureStack } from "./figure-stack.js";
import { h, show } from "../dom.js";
import { runFigure } from "../figures.js";
import { number } from "../format.js";
import { POINT_FIGURES } from "../job-tabs.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../view-address.js").Point} Point */

/** @type {Record<string, string>} */
const TITLES = { "point-acceleration": "Acceleration of the point", "point-displacement": "Displacement of the point" };

export class PointPlots extends HTMLElement {
  #run = "";
  #library = "";
  /** @type {RunView | null} */
  #view = null;
  /** @type {FigureStack | null} */
  #stack = null;
  #heading = h("h2", { tabindex: -1 });
  #ended = new AbortController();

  /** @param {{ run: string, view: RunView, library: string }} options */
  bind({ run, view, library }) {
    this.#run = run;
    this.#view = view;
    this.#library = library;
    this.classList.add("point-plots");
    view.watch(["place"], ({ place }) => this.#open(place, true), this.#ended.signal);
    this.#open(view.look.place, false);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** Another run; the place stays. @param {string} run */
  set run(run) {
    this.#run = run;
    this.#stack = null;
    this.#open(this.#view?.look.place ?? null, false);
  }

  /** Fetches again what a running computation has added. */
  refresh() {
    void this.#stack?.refresh();
  }

  /**
   * @param {Point | null} place
   * @param {boolean} fresh whether somebody has just chosen it
   */
  #open(place, fresh) {
    this.hidden = place === null;
    if (!place) {
      this.#stack = null;
      return show(this);
    }
    show(this.#heading, `Point at ${words(place)}`);
    if (this.#stack) return; // its charts hear of the place themselves
    const view = /** @type {RunView} */ (this.#view);
    const stack = /** @type {FigureStack} */ (h("tb-figure-stack", { class: "pair" }));
    stack.bind({
      view,
      library: this.#library,
      figures: POINT_FIGURES.map((name) => ({ name, title: TITLES[name], needs_place: true })),
      source: (name) => runFigure(this.#run, name),
    });
    this.#stack = stack;
    const close = h("button", { type: "button", class: "quiet", onclick: () => view.set({ place: null }) }, "Close");
    show(this, h("div", { class: "row spread section-head" }, this.#heading, close), stack);
    stack.shown = true;
    if (fresh) this.scrollIntoView({ block: "nearest" });
  }
}

/** @param {Point} place */
const words = ([x, y, z]) => `x = ${number(x, 4)} m, y = ${number(y, 3)} m, z = ${number(z, 3)} m`;

customElements.define("tb-point-plots", PointPlots);
