// @ts-check
/**
 * The natural modes: frequency, damping, and which shape each one is. A row chooses the shape that
 * swings in the 3D view. Emits `mode` {mode}.
 */
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").Mode} Mode */

export class ModesTable extends HTMLElement {
  /** @type {HTMLElement[]} */
  #rows = [];

  /** The mode that is shown, counted from 1. @param {number} mode */
  set chosen(mode) {
    for (const [index, row] of this.#rows.entries()) {
      if (index + 1 === mode) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
    }
  }

  /** @param {Mode[]} modes in ascending order of frequency */
  set modes(modes) {
    this.classList.add("card", "modes");
    // A plain beam's modes need no names: they are sines, one after the other.
    const named = modes.some((mode) => mode.name);
    const likened = modes.some((mode) => mode.assurance > 0);
    this.#rows = modes.map((mode) => this.#row(mode, named, likened));
    const heads = ["Mode", "Frequency [Hz]", "Damping [%]", ...(named ? [SHAPE] : []), ...(likened ? ["MAC"] : [])];
    show(
      this,
      h("h2", null, "Natural modes"),
      h(
        "div",
        { class: "scroll", tabindex: 0, role: "region", "aria-label": "Natural modes" },
        h(
          "table",
          null,
          h("thead", null, h("tr", null, heads.map((text) => h("th", { scope: "col", class: text === SHAPE && "shape" }, text)))),
          h("tbody", null, this.#rows),
        ),
      ),
      likened && h("p", { class: "soft small" }, MEANING),
    );
  }

  /**
   * @param {Mode} mode
   * @param {boolean} named
   * @param {boolean} likened whether shapes were compared with known ones
   */
  #row(mode, named, likened) {
    const choose = () => this.dispatchEvent(new CustomEvent("mode", { detail: { mode: mode.number }, bubbles: true }));
    const button = h("button", { type: "button", class: "link", "aria-label": `Show mode ${mode.number}` }, mode.number);
    return h(
      "tr",
      { class: named && mode.name ? "named" : "", onclick: choose },
      h("th", { scope: "row" }, button),
      h("td", null, mode.frequency.toFixed(mode.frequency < 1 ? 3 : 2)),
      h("td", null, (mode.damping * 100).toFixed(2)),
      named && h("td", { class: "shape" }, mode.name || "–"),
      likened && h("td", null, mode.name ? mode.assurance.toFixed(3) : "–"),
    );
  }
}

const SHAPE = "Shape";
const MEANING =
  "Shapes are recognised over points of the deck: bending is a half sine of one span, second " +
  "bending a full sine, torsion a half sine on one side against the other. The modal assurance " +
  "criterion (MAC) is 1 for equal shapes; a mode bears a name from 0.80 on.";

customElements.define("tb-modes-table", ModesTable);
