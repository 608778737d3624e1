// @ts-check
/** What the 3D view's colours stand for: a scale with its quantity and its values. */
import { h, s, show } from "../dom.js";
import { number, unitText } from "../format.js";

/** @typedef {import("../types.js").ColourBar} ColourBarData */

const WIDTH = 200;
const HEIGHT = 12;
let made = 0;

export class ColourBar extends HTMLElement {
  #shown = "";

  /** @param {ColourBarData | null | undefined} bar in display units; null where nothing is coloured */
  set bar(bar) {
    const text = JSON.stringify(bar ?? null);
    if (text === this.#shown) return;
    this.#shown = text;
    this.classList.add("colour-bar");
    this.hidden = !bar;
    if (bar) this.#draw(bar);
    else show(this);
  }

  /** @param {ColourBarData} bar */
  #draw(bar) {
    const unit = unitText(bar.unit);
    const ends = [bar.minimum, (bar.minimum + bar.maximum) / 2, bar.maximum];
    const title = `${bar.quantity}${unit ? ` [${unit}]` : ""}`;
    show(
      this,
      h("p", { class: "small" }, title),
      this.#scale(bar, `${title}: ${number(bar.minimum, 3)} to ${number(bar.maximum, 3)} ${unit}`),
      h("div", { class: "ends small", "aria-hidden": "true" }, ends.map((value) => h("span", null, number(value, 3)))),
    );
  }

  /**
   * @param {ColourBarData} bar
   * @param {string} words
   */
  #scale(bar, words) {
    made += 1;
    const id = `colour-bar-${made}`;
    return s(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img", "aria-label": words },
      s(
        "defs",
        null,
        s("linearGradient", { id }, bar.stops.map(([at, colour]) => s("stop", { offset: at, "stop-color": colour }))),
      ),
      s("rect", { width: WIDTH, height: HEIGHT, fill: `url(#${id})` }),
    );
  }
}

customElements.define("tb-colour-bar", ColourBar);
