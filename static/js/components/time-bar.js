// @ts-check
/** Play, pause, slider and speed of the one time cursor. */
import { h, s, show } from "../dom.js";

/** @typedef {import("../time-cursor.js").TimeCursor} TimeCursor */

const RATES = [0.02, 0.05, 0.1, 0.25, 0.5, 1];
/** A press of an arrow key moves by this part of the run. */
const STEPS = 1000;

export class TimeBar extends HTMLElement {
  /** @type {TimeCursor | null} */
  #cursor = null;
  #ended = new AbortController();
  #button = h("button", { type: "button", class: "primary play" });
  #slider = h("input", { type: "range", "aria-label": "Time", min: 0, max: STEPS, step: 1 });
  #clock = h("output", { class: "clock" });

  /** @param {TimeCursor} cursor */
  set cursor(cursor) {
    this.#cursor = cursor;
    this.classList.add("card", "time-bar");
    this.#button.onclick = () => cursor.toggle();
    this.#slider.oninput = () => {
      cursor.pause();
      cursor.seek(cursor.start + ((cursor.end - cursor.start) * Number(this.#slider.value)) / STEPS);
    };
    const rate = h(
      "select",
      { "aria-label": "Speed of the playback", onchange: () => cursor.setRate(Number(rate.value)) },
      RATES.map((value) => h("option", { value, selected: value === cursor.rate }, value === 1 ? "real time" : `${value} ×`)),
    );
    show(this, this.#button, this.#slider, this.#clock, rate);
    cursor.addEventListener("change", () => this.#update(), { signal: this.#ended.signal });
    this.#update();
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  #update() {
    const cursor = this.#cursor;
    if (!cursor) return;
    const length = cursor.end - cursor.start;
    this.#slider.value = String(length > 0 ? ((cursor.time - cursor.start) / length) * STEPS : 0);
    this.#slider.disabled = length <= 0;
    this.#button.disabled = length <= 0;
    const text = `${cursor.time.toFixed(3)} s`;
    this.#slider.setAttribute("aria-valuetext", text);
    show(this.#clock, text);
    const state = cursor.playing ? "pause" : "play";
    if (this.#button.dataset.state === state) return;
    this.#button.dataset.state = state;
    this.#button.setAttribute("aria-label", cursor.playing ? "Pause" : "Play");
    const d = cursor.playing ? "M3 1 h3 v12 h-3 Z M8 1 h3 v12 h-3 Z" : "M3 1 L12.5 7 L3 13 Z";
    show(this.#button, s("svg", { viewBox: "0 0 14 14", width: 14, height: 14, "aria-hidden": "true" }, s("path", { d, fill: "currentColor" })));
  }
}

customElements.define("tb-time-bar", TimeBar);
