// @ts-check
/**
 * The 3D view of a run: an iframe of the server's viewer, steered by what the page looks at.
 *
 * The page owns the time: while playing, both sides move at the same rate, and the page sets the
 * viewer right every two seconds. A click in the view becomes the page's `place`.
 */
import { ColourBar } from "./colour-bar.js";
import { ViewerControls } from "./viewer-controls.js";
import { ViewerMessage } from "./viewer-message.js";
import { ViewerStills } from "./viewer-stills.js";
import { h, show } from "../dom.js";
import { webGraphics } from "../graphics.js";
import { store } from "../store.js";
import { currentTheme } from "../theme.js";
import { ViewerEmbed } from "../viewer-embed.js";
import { ViewerSession } from "../viewer-session.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../types.js").ViewerState} ViewerState */
/** @typedef {import("../viewer-session.js").Steering} Steering */

/** [ms] */
const SET_RIGHT = 2000;
/** What a view lacks for more looks than this, connection or colours, it will not get by itself. */
const PATIENCE = 2;

export class ViewerFrame extends HTMLElement {
  #run = "";
  /** @type {RunView | null} */
  #view = null;
  /** @type {ViewerSession | null} */
  #session = null;
  #ended = new AbortController();
  #lastSync = 0;
  #alone = 0;
  #plain = 0;
  #paused = false;
  /** A scale that suits the run; null leaves the viewer its own. @type {number | null} */
  #proposed = null;
  /** @type {ViewerEmbed | null} */
  #embedded = null;
  #place = h("div", { class: "viewer-place" });
  #message = /** @type {ViewerMessage} */ (h("tb-viewer-message", { class: "viewer-message", hidden: true }));
  #bar = /** @type {ColourBar} */ (h("tb-colour-bar", { hidden: true }));
  #controls = /** @type {ViewerControls} */ (h("tb-viewer-controls", { hidden: true }));
  /** What is seen where there is no 3D. */
  stills = /** @type {ViewerStills} */ (h("tb-viewer-stills"));

  /** @param {{ run: string, view: RunView }} options */
  bind({ run, view }) {
    this.#run = run;
    this.#view = view;
    this.classList.add("card", "viewer");
    this.#controls.bind({ run, view });
    this.stills.bind({ run, view });
    show(this.#place, this.stills);
    show(this, h("div", { class: "viewer-stage" }, this.#place, this.#bar, this.#message), this.#controls);
    const signal = this.#ended.signal;
    view.cursor.addEventListener("change", (event) => this.#follow(/** @type {CustomEvent} */ (event).detail), { signal });
    view.watch(["colour", "scale", "camera", "hidden", "mode"], () => this.#steer(this.#looks()), signal);
    store.watch("theme", () => this.#steer({ theme: currentTheme() }), signal);
    store.watch("connected", (connected) => connected && this.#embedded?.wake(), signal);
    addEventListener("pagehide", () => this.#session?.close(), { signal });
  }

  disconnectedCallback() {
    this.#ended.abort();
    this.#session?.close();
  }

  /** Another run of the same job: the session and its page stay. @param {string} run */
  set run(run) {
    if (run === this.#run) return;
    this.#run = run;
    this.stills.run = run;
    this.#controls.run = run;
    this.#session?.steer({ run, ...this.#view?.cursor.state, ...this.#looks() });
  }

  /** A scale at which the deformation is well seen; what somebody chose stays. @param {number} scale */
  propose(scale) {
    if (this.#proposed === scale) return;
    this.#proposed = scale;
    if (webGraphics() === "none") this.#controls.plain = scale;
    this.#steer(this.#looks());
  }

  /**
   * Asks the server for a viewing session and shows it.
   *
   * @param {{ computing?: boolean }} [options] a browser that draws in software would take the
   *   processor from a run that still computes: then it waits for a press or for the end
   */
  async start({ computing = false } = {}) {
    if (this.#session || !this.isConnected) return;
    const graphics = webGraphics();
    if (graphics === "none") return this.#paint();
    if (computing && graphics === "software") {
      this.#message.say("This browser draws 3D in software, which slows the computation down. The view opens when the run is done.", "Watch it now", () => void this.start());
      return;
    }
    this.#message.say("");
    const session = new ViewerSession();
    this.#session = session;
    session.addEventListener("state", (event) => this.#take(/** @type {CustomEvent} */ (event).detail));
    session.addEventListener("lost", () => this.#lost());
    try {
      const url = await session.open(this.#run, currentTheme());
      if (this.isConnected) this.#embed(url);
      else session.close();
    } catch (error) {
      this.#session = null;
      this.#message.say(`No 3D view: ${/** @type {Error} */ (error).message}`, "Try again", () => void this.start());
    }
  }

  /** The server draws: what can be chosen of it is less. */
  #paint() {
    this.stills.start();
    this.#controls.hidden = false;
    this.#controls.plain = this.#proposed ?? 1;
  }

  /** @param {string} url */
  #embed(url) {
    const embed = (this.#embedded = new ViewerEmbed(url));
    embed.addEventListener("ready", () => this.#steer({ ...this.#view?.cursor.state, ...this.#looks() }));
    embed.addEventListener("press", () => void this.#pick());
    show(this.#place, embed.element);
  }

  async #pick() {
    const picked = await this.#session?.pick();
    if (picked) this.#view?.set({ place: picked.point });
  }

  /** What was chosen, as far as this run can show it. @returns {Steering} */
  #looks() {
    const { colour, scale, camera, hidden, mode } = /** @type {RunView} */ (this.#view).look;
    const state = this.#session?.state;
    const size = scale ?? this.#proposed;
    return {
      ...(size !== null && { scale: size }),
      ...(state?.available_colours.includes(colour) && { colour }),
      ...(state && camera && camera !== state.camera && { camera }),
      ...(state?.modal && { mode: mode - 1 }),
      ...(state && { layers: state.available_layers.filter((name) => !hidden.includes(name)) }),
    };
  }

  /** @param {ViewerState} state */
  #take(state) {
    const first = this.#controls.hidden;
    this.#controls.hidden = false;
    this.#controls.state = state;
    this.#bar.bar = state.colour_bar;
    this.dataset.session = state.session;
    if (first) this.#steer(this.#looks());
    this.#obey(state);
    this.#alone = state.clients > 0 ? 0 : this.#alone + 1;
    if (this.#alone > PATIENCE) this.#embedded?.wake();
    const plain = state.colour !== "none" && state.smooth && state.clients > 0 && this.#embedded?.smooth === false;
    this.#plain = plain ? this.#plain + 1 : 0;
    // A page that shows no colours per vertex gets one colour for each element.
    if (this.#plain > PATIENCE) this.#steer({ smooth: false });
  }

  /** The server may stop a view that has played longest, for another one. @param {ViewerState} state */
  #obey({ paused }) {
    const cursor = this.#view?.cursor;
    if (paused && !this.#paused) {
      cursor?.pause();
      this.#message.say(paused, "Resume", () => cursor?.play());
    } else if (!paused && this.#paused) this.#message.say("");
    this.#paused = paused !== "";
  }

  /** @param {{ time: number, playing: boolean, rate: number, reason: string }} state */
  #follow({ reason, ...state }) {
    const now = performance.now();
    if (reason === "tick" && now - this.#lastSync < SET_RIGHT) return;
    this.#lastSync = now;
    this.#steer(state);
  }

  /** @param {Steering} state */
  #steer = (state) => this.#session?.steer(state);

  #lost() {
    this.#session = null;
    this.#embedded = null;
    this.#controls.hidden = true;
    show(this.#place);
    this.#message.say("The 3D view was closed after a pause.", "Open it again", () => void this.start());
  }
}

customElements.define("tb-viewer-frame", ViewerFrame);
