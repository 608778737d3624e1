// @ts-check
/**
 * The 3D view of a run: an iframe of the server's viewer, steered by the page's time cursor.
 *
 * Everything the page knows of the viewer is in this file. The page owns the time: while playing,
 * both sides move at the same rate, and the page sets the viewer right every two seconds.
 */
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { webGraphics } from "../graphics.js";

/** @typedef {import("../time-cursor.js").TimeCursor} TimeCursor */

const SCALES = [1, 10, 20, 50, 100, 200, 500, 1000];
const CAMERAS = /** @type {const} */ ([
  ["overview", "overview"],
  ["side", "from the side"],
  ["section", "section at mid-span"],
  ["follow", "follow the first bogie"],
  ["free", "free"],
]);
const DARK = matchMedia("(prefers-color-scheme: dark)");
/** [ms] */
const SET_RIGHT = 2000;
/** Steering at most this often; the latest value wins. [ms] */
const PACE = 60;

export class ViewerFrame extends HTMLElement {
  #run = "";
  #session = "";
  /** @type {TimeCursor | null} */
  #cursor = null;
  #ended = new AbortController();
  /** @type {Record<string, unknown> | null} */
  #pending = null;
  #sending = false;
  #lastSync = 0;
  #place = h("div", { class: "viewer-place" });
  /** A scale that suits the run; null once somebody has chosen one. @type {number | null} */
  #proposed = 500;
  #scale = h("select", { "aria-label": "Scale of the deformation", onchange: () => this.#chooseScale() });

  /**
   * @param {{ run: string, cursor: TimeCursor, fallback: Node }} options `fallback` is shown until
   *   and unless the view is there
   */
  bind({ run, cursor, fallback }) {
    this.#run = run;
    this.#cursor = cursor;
    this.classList.add("card", "viewer");
    show(this.#place, fallback);
    show(this, this.#place);
    const signal = this.#ended.signal;
    cursor.addEventListener("change", (event) => this.#follow(/** @type {CustomEvent} */ (event).detail), { signal });
    DARK.addEventListener("change", () => this.#steer({ theme: theme() }), { signal });
    addEventListener("pagehide", () => this.#close(), { signal });
  }

  disconnectedCallback() {
    this.#ended.abort();
    this.#close();
  }

  /** Whether the view is open or opening. */
  get open() {
    return this.#session !== "";
  }

  /**
   * Asks the server for a viewing session and shows it.
   *
   * @param {{ computing?: boolean }} [options] a browser that draws in software would take the
   *   processor from a run that still computes: then it waits for a press or for the end
   */
  async start({ computing = false } = {}) {
    if (this.open || !this.isConnected) return;
    const graphics = webGraphics();
    if (graphics === "none") {
      show(this.#place, h("p", { class: "viewer-wait soft" }, "This browser offers no WebGL, so there is no 3D view. The plots below are complete."));
      return;
    }
    if (computing && graphics === "software") {
      this.#offer("This browser draws 3D in software, which slows the computation down. The view opens when the run is done.", "Watch it now");
      return;
    }
    this.#session = "opening";
    try {
      const { session, url } = await api.openViewer(this.#run, { theme: theme() });
      this.#session = session;
      if (!this.isConnected) return void this.#close();
      this.#embed(url);
    } catch (error) {
      this.#session = "";
      this.#say(`No 3D view: ${/** @type {Error} */ (error).message}`);
    }
  }

  /** @param {string} url */
  #embed(url) {
    const frame = h("iframe", { src: url, title: "3D view of the viaduct and the train", allow: "fullscreen" });
    // An unfocused frame does not reconnect by itself after a gap.
    frame.addEventListener("load", () => {
      const before = document.activeElement;
      frame.contentWindow?.focus();
      if (before instanceof HTMLElement && before !== document.body) before.focus();
      this.#steer({ ...this.#cursor?.state, scale: Number(this.#scale.value) });
    });
    this.querySelector(".viewer-controls")?.remove();
    this.append(this.#controls());
    show(this.#place, frame);
  }

  /** A scale at which the deformation is well seen; what somebody chose stays. @param {number} scale */
  propose(scale) {
    if (this.#proposed === null || this.#proposed === scale) return;
    this.#proposed = scale;
    this.#showScales(scale);
    this.#steer({ scale });
  }

  #chooseScale() {
    this.#proposed = null;
    this.#steer({ scale: Number(this.#scale.value) });
  }

  /** @param {number} current */
  #showScales(current) {
    const scales = [...new Set([...SCALES, current])].sort((a, b) => a - b);
    show(
      this.#scale,
      scales.map((value) => h("option", { value, selected: value === current }, `deformation × ${value}`)),
    );
  }

  #controls() {
    if (!this.#scale.value) this.#showScales(this.#proposed ?? 500);
    const camera = h(
      "select",
      { "aria-label": "Camera", onchange: () => this.#steer({ camera: camera.value }) },
      CAMERAS.map(([value, text]) => h("option", { value }, text)),
    );
    return h("div", { class: "row viewer-controls" }, this.#scale, camera);
  }

  /** @param {{ time: number, playing: boolean, rate: number, reason: string }} state */
  #follow({ reason, ...state }) {
    const now = performance.now();
    if (reason === "tick" && now - this.#lastSync < SET_RIGHT) return;
    this.#lastSync = now;
    this.#steer(state);
  }

  /** @param {Record<string, unknown>} state */
  #steer(state) {
    if (!this.#session || this.#session === "opening") return;
    this.#pending = { ...this.#pending, ...state };
    if (!this.#sending) void this.#send();
  }

  async #send() {
    this.#sending = true;
    while (this.#pending && this.isConnected) {
      const state = this.#pending;
      this.#pending = null;
      try {
        await api.steerViewer(this.#session, state);
      } catch (error) {
        if (/** @type {any} */ (error).status === 404) this.#lost();
      }
      await new Promise((resolve) => setTimeout(resolve, PACE));
    }
    this.#sending = false;
  }

  #lost() {
    this.#session = "";
    this.#pending = null;
    this.querySelector(".viewer-controls")?.remove();
    this.#offer("The 3D view was closed after a pause.", "Open it again");
  }

  /**
   * @param {string} text
   * @param {string} action
   */
  #offer(text, action) {
    if (this.#place.textContent === text + action) return;
    const button = h("button", { type: "button", onclick: () => void this.start() }, action);
    show(this.#place, h("div", { class: "viewer-note" }, h("p", { class: "soft" }, text), button));
  }

  /** @param {string} text */
  #say(text) {
    this.querySelector(".viewer-note")?.remove();
    this.append(h("p", { class: "viewer-note small soft" }, text));
  }

  #close() {
    if (this.#session && this.#session !== "opening") void api.closeViewer(this.#session).catch(() => {});
    this.#session = "";
  }
}

/** The view wears the page's theme. */
const theme = () => (DARK.matches ? "dark" : "light");

customElements.define("tb-viewer-frame", ViewerFrame);
