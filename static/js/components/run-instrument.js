// @ts-check
/**
 * The 3D view, the time bar under it and the histories of a chosen point: what stays in sight
 * whatever tab is open. The keys are here too.
 */
import { KeyHelp } from "./key-help.js";
import { PointPlots } from "./point-plots.js";
import { TimeBar } from "./time-bar.js";
import { ViewerFrame } from "./viewer-frame.js";
import { h, show } from "../dom.js";
import { pleasingScale } from "../scale.js";
import { actionOf } from "../time-keys.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../moment.js").Moment} Moment */
/** @typedef {{ run: string, view: RunView, library: string, modal?: boolean }} InstrumentOptions */

/** One swing of a mode takes this long at rate 1. [s] */
const SWING = 1;
const LEAP = 10;

export class RunInstrument extends HTMLElement {
  /** @type {RunView | null} */
  #view = null;
  #ended = new AbortController();
  #viewer = /** @type {ViewerFrame} */ (h("tb-viewer-frame"));
  #bar = /** @type {TimeBar} */ (h("tb-time-bar"));
  #points = /** @type {PointPlots} */ (h("tb-point-plots", { hidden: true }));
  #help = /** @type {KeyHelp} */ (h("tb-key-help"));
  /** @type {readonly Moment[]} */
  #moments = [];
  /** The cursor goes where the computation is, until somebody takes it. */
  #following = true;
  /** What the address asks for, once the run's length is known. @type {number | null} */
  #asked = null;

  /** @param {InstrumentOptions} options */
  bind({ run, view, library, modal = false }) {
    this.#view = view;
    this.#asked = view.look.time;
    this.#following = this.#asked === null;
    this.#bar.cursor = view.cursor;
    this.#viewer.bind({ run, view });
    if (!modal) this.#points.bind({ run, view, library });
    show(this, this.#viewer, this.#bar, this.#points, this.#help);
    const signal = this.#ended.signal;
    view.cursor.addEventListener("change", (event) => this.#move(/** @type {CustomEvent} */ (event).detail.reason), { signal });
    this.addEventListener("help", () => this.#help.open());
    addEventListener("keydown", (event) => this.#key(event), { signal });
    if (modal) this.#swing();
  }

  disconnectedCallback() {
    this.#view?.cursor.pause();
    this.#ended.abort();
  }

  /** @returns {ViewerFrame} */
  get viewer() {
    return this.#viewer;
  }

  /** Another run of the same job; the place stays, the time goes to the run's own moment. @param {string} run */
  set run(run) {
    this.#following = true;
    this.#viewer.run = run;
    this.#points.run = run;
  }

  /** Times worth a look; the first is shown unless somebody has chosen another. @param {readonly Moment[]} moments */
  set moments(moments) {
    this.#moments = moments;
    this.#bar.moments = moments;
    this.#goFirst();
  }

  /**
   * The displacements of the run so far: how long it is, where the train is at a time, which scale
   * of the deformation suits it.
   *
   * @param {import("../types.js").Figure} figure
   */
  set overview({ layout, table }) {
    const { end, window_start: first, speed, start_position: start } = layout.meta;
    this.#viewer.propose(pleasingScale(table));
    const cursor = /** @type {RunView} */ (this.#view).cursor;
    this.#viewer.stills.motion = { speed, start };
    if (cursor.end === end) return;
    cursor.setRange(0, end);
    if (this.#asked !== null) cursor.follow(this.#asked);
    else if (this.#moments.length) this.#goFirst();
    else cursor.follow(first);
    this.#asked = null;
  }

  /**
   * How far the run is.
   *
   * @param {string} state
   * @param {number | null} time simulated time [s]
   */
  progress(state, time) {
    void this.#viewer.start({ computing: state === "running" });
    if (this.#following && time !== null && state === "running") this.#view?.cursor.follow(time);
    if (state !== "queued") this.#points.refresh();
  }

  #goFirst() {
    const cursor = this.#view?.cursor;
    if (this.#following && cursor && cursor.end > 0 && this.#moments.length) cursor.follow(this.#moments[0].time);
  }

  /** A mode swings on and on; with reduced motion it rests at its greatest. */
  #swing() {
    const cursor = /** @type {RunView} */ (this.#view).cursor;
    cursor.looping = true;
    cursor.interval = SWING / 36;
    cursor.setRate(0.5);
    cursor.setRange(0, SWING);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (this.#asked !== null || still) cursor.follow(this.#asked ?? 0);
    else cursor.play();
  }

  /** @param {string} reason */
  #move(reason) {
    if (reason === "seek" || reason === "play") this.#following = false;
    if (reason === "play") requestAnimationFrame((now) => this.#tick(now));
  }

  /** @param {number} now */
  #tick(now) {
    const cursor = this.#view?.cursor;
    if (!cursor?.playing || this.#ended.signal.aborted) return;
    cursor.tick(now);
    requestAnimationFrame((next) => this.#tick(next));
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const cursor = this.#view?.cursor;
    const target = event.target instanceof Element ? event.target : null;
    const action = actionOf(event, target);
    if (!action || !cursor || cursor.end <= cursor.start || this.hidden) return;
    event.preventDefault();
    const peak = this.#moments[0];
    const acts = {
      toggle: () => cursor.toggle(),
      forward: () => cursor.step(1),
      back: () => cursor.step(-1),
      "leap-forward": () => cursor.step(LEAP),
      "leap-back": () => cursor.step(-LEAP),
      faster: () => cursor.changeRate(1),
      slower: () => cursor.changeRate(-1),
      peak: () => peak && (cursor.pause(), cursor.seek(peak.time)),
      help: () => this.#help.open(),
    };
    acts[action]();
  }
}

customElements.define("tb-run-instrument", RunInstrument);
