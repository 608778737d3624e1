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
import { ViewerHealth } from "../viewer-health.js";
import { looksOf } from "../viewer-looks.js";
import { ViewerPose } from "../viewer-pose.js";
import { ViewerSession } from "../viewer-session.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../types.js").ViewerState} ViewerState */
/** @typedef {import("../viewer-session.js").Steering} Steering */

/** [ms] */
const SET_RIGHT = 2000;

export class ViewerFrame extends HTMLElement {
  #run = "";
  /** @type {RunView | null} */
  #view = null;
  /** @type {ViewerSession | null} */
  #session = null;
  #ended = new AbortController();
  #lastSync = 0;
  #health = new ViewerHealth();
  #pose = /** @type {ViewerPose | null} */ (null);
  /** Whether the last session was refused or lost. */
  #refused = false;
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
    this.#pose = new ViewerPose(view, signal);
    view.cursor.addEventListener("change", (event) => this.#follow(/** @type {CustomEvent} */ (event).detail), { signal });
    view.watch(["colour", "scale", "camera", "hidden", "mode", "place"], () => this.#steer(this.#looks()), signal);
    store.watch("theme", () => this.#steer({ theme: currentTheme() }), signal);
    store.watch("connected", (connected) => connected && this.#repeat(), signal);
    addEventListener("pagehide", () => this.#session?.close(), { signal });
    // The page comes back from the browser's memory, its session does not.
    addEventListener("pageshow", ({ persisted }) => persisted && this.#session && this.#lost(), { signal });
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
    this.#repeat();
  }

  /** A scale at which the deformation is well seen; what somebody chose stays. @param {number} scale */
  propose(scale) {
    if (this.#proposed === scale) return;
    this.#proposed = scale;
    this.stills.scale = scale;
    if (webGraphics() === "none") this.#controls.plain = scale;
    this.#steer(this.#looks());
  }

  /**
   * Asks the server for a viewing session and shows it. What was refused or lost opens again where
   * somebody asks for it, not with each step of the computation.
   *
   * @param {{ computing?: boolean, asked?: boolean }} [options] a browser that draws in software would take the
   *   processor from a run that still computes: then it waits for a press or for the end
   */
  async start({ computing = false, asked = false } = {}) {
    if (this.#session || !this.isConnected || (this.#refused && !asked)) return;
    const graphics = webGraphics();
    if (graphics === "none") return this.#paint();
    if (computing && graphics === "software") {
      this.#message.say("This browser draws 3D in software, which slows the computation down. The view opens when the run is done.", "Watch it now", this.#open);
      return;
    }
    this.#refused = false;
    this.#message.say("");
    const session = (this.#session = new ViewerSession());
    this.#health = new ViewerHealth();
    session.addEventListener("state", (event) => this.#take(/** @type {CustomEvent} */ (event).detail));
    session.addEventListener("lost", () => this.#lost());
    this.#pose?.begin(session);
    try {
      const url = await session.open(this.#run, currentTheme());
      if (this.isConnected) this.#embed(url);
      else session.close();
    } catch (error) {
      this.#session = null;
      this.#refused = true;
      this.#message.say(`No 3D view: ${/** @type {Error} */ (error).message}`, "Try again", this.#open);
    }
  }

  #open = () => void this.start({ asked: true });

  /** The server draws: what can be chosen of it is less. */
  #paint() {
    this.stills.start();
    this.#controls.hidden = false;
    this.#controls.plain = this.#proposed ?? 1;
  }

  /** @param {string} url */
  #embed(url) {
    const embed = (this.#embedded = new ViewerEmbed(url));
    embed.addEventListener("ready", () => this.#repeat());
    embed.addEventListener("press", () => void this.#pick());
    embed.addEventListener("turn", () => this.#pose?.rest());
    show(this.#place, embed.element);
  }

  async #pick() {
    const picked = await this.#session?.pick();
    if (picked) this.#view?.set({ place: picked.point });
  }

  /** What was chosen, as far as this run can show it. @returns {Steering} */
  #looks = () => looksOf(/** @type {RunView} */ (this.#view).look, this.#proposed, this.#session?.state, this.#pose?.asks);

  /** Says everything again, where the viewer may have missed some. */
  #repeat() {
    this.#embedded?.wake();
    this.#steer({ run: this.#run, ...this.#view?.cursor.state, ...this.#looks() });
  }

  /** @param {ViewerState} state */
  #take(state) {
    const first = this.#controls.hidden;
    this.#controls.hidden = false;
    this.#controls.state = state;
    this.#bar.bar = state.colour_bar;
    this.dataset.session = state.session;
    // A run that had no step yet when it was chosen is there by now.
    if (first || state.run !== this.#run) this.#repeat();
    const { wake, simplify, halted, resumed } = this.#health.examine(state, this.#embedded?.smooth);
    if (halted) this.#view?.cursor.pause();
    if (halted) this.#message.say(state.paused, "Resume", () => this.#view?.cursor.play());
    if (resumed) this.#message.say("");
    if (wake) this.#embedded?.wake();
    if (simplify) this.#steer({ smooth: false });
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
    this.#refused = true;
    this.#controls.hidden = true;
    delete this.dataset.session;
    show(this.#place);
    this.#message.say("The 3D view was closed after a pause.", "Open it again", this.#open);
  }
}

customElements.define("tb-viewer-frame", ViewerFrame);
