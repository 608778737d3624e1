// @ts-check
/** Play, pause, steps, slider, speed and jumps of the one time cursor. Emits `help`. */
import { h, s, show } from "../dom.js";
import { RATES } from "../time-cursor.js";

/** @typedef {import("../time-cursor.js").TimeCursor} TimeCursor */
/** @typedef {import("../moment.js").Moment} Moment */

/** Steps of the slider where the pictures are not known. */
const STEPS = 1000;

const ICONS = {
  play: "M3 1 L12.5 7 L3 13 Z",
  pause: "M3 1 h3 v12 h-3 Z M8 1 h3 v12 h-3 Z",
  back: "M11 1 L4.5 7 L11 13 Z M2 1 h2 v12 h-2 Z",
  forward: "M3 1 L9.5 7 L3 13 Z M10 1 h2 v12 h-2 Z",
};

export class TimeBar extends HTMLElement {
  /** @type {TimeCursor | null} */
  #cursor = null;
  #ended = new AbortController();
  #button = h("button", { type: "button", class: "primary icon" });
  #slider = h("input", { type: "range", "aria-label": "Time", min: 0, max: STEPS, step: 1 });
  #clock = h("output", { class: "clock" });
  #rate = h("select", { "aria-label": "Speed of the playback", onchange: () => this.#cursor?.setRate(Number(this.#rate.value)) });
  #jump = h("select", { "aria-label": "Jump to", class: "jump", hidden: true, onchange: () => this.#goTo() });
  /** @type {readonly Moment[]} */
  #moments = [];

  /** @param {TimeCursor} cursor */
  set cursor(cursor) {
    this.#cursor = cursor;
    this.classList.add("card", "time-bar");
    this.#button.onclick = () => cursor.toggle();
    this.#slider.oninput = () => {
      cursor.pause();
      cursor.seek(cursor.start + ((cursor.end - cursor.start) * Number(this.#slider.value)) / Number(this.#slider.max));
    };
    show(this.#rate, RATES.map((value) => h("option", { value, selected: value === cursor.rate }, value === 1 ? "real time" : `${value} ×`)));
    show(
      this,
      h("div", { class: "row transport" }, this.#step("back", -1), this.#button, this.#step("forward", 1)),
      this.#slider,
      this.#clock,
      this.#jump,
      this.#rate,
      h("button", { type: "button", class: "quiet icon", "aria-label": "Keys", title: "Keys (?)", onclick: () => this.dispatchEvent(new CustomEvent("help", { bubbles: true })) }, "?"),
    );
    cursor.addEventListener("change", () => this.#update(), { signal: this.#ended.signal });
    this.#update();
  }

  /** Times that are worth a look; P goes to the first. @param {readonly Moment[]} moments */
  set moments(moments) {
    this.#moments = moments;
    this.#jump.hidden = moments.length === 0;
    show(
      this.#jump,
      h("option", { value: "" }, "Jump to…"),
      moments.map(({ words, time }, index) => h("option", { value: index }, `${words}, ${time.toFixed(3)} s`)),
    );
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  #goTo() {
    const moment = this.#moments[Number(this.#jump.value || Number.NaN)];
    this.#jump.value = "";
    if (!moment) return;
    this.#cursor?.pause();
    this.#cursor?.seek(moment.time);
  }

  /**
   * @param {"back" | "forward"} icon
   * @param {number} pictures
   */
  #step(icon, pictures) {
    const words = icon === "back" ? "One picture back" : "One picture forward";
    return h("button", { type: "button", class: "quiet icon", "aria-label": words, title: words, onclick: () => this.#cursor?.step(pictures) }, drawn(icon));
  }

  #update() {
    const cursor = this.#cursor;
    if (!cursor) return;
    const length = cursor.end - cursor.start;
    const steps = cursor.interval > 0 ? Math.max(1, Math.round(length / cursor.interval)) : STEPS;
    this.#slider.max = String(steps);
    this.#slider.value = String(length > 0 ? ((cursor.time - cursor.start) / length) * steps : 0);
    this.#slider.disabled = length <= 0;
    this.#button.disabled = length <= 0;
    const text = cursor.looping ? `${Math.round(cursor.time * 360)}°` : `${cursor.time.toFixed(3)} s`;
    this.#slider.setAttribute("aria-valuetext", text);
    show(this.#clock, text);
    this.#rate.value = String(cursor.rate);
    const state = cursor.playing ? "pause" : "play";
    if (this.#button.dataset.state === state) return;
    this.#button.dataset.state = state;
    this.#button.setAttribute("aria-label", cursor.playing ? "Pause" : "Play");
    show(this.#button, drawn(state));
  }
}

/** @param {keyof typeof ICONS} icon */
const drawn = (icon) =>
  s("svg", { viewBox: "0 0 14 14", width: 14, height: 14, "aria-hidden": "true" }, s("path", { d: ICONS[icon], fill: "currentColor" }));

customElements.define("tb-time-bar", TimeBar);
