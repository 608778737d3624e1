// @ts-check
/** The natural modes of a viaduct: frequency, damping, and which shape each one is. */
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").Mode} Mode */

export class ModesTable extends HTMLElement {
  /** @param {Mode[]} modes in ascending order of frequency */
  set modes(modes) {
    this.classList.add("card", "modes");
    // A plain beam's modes need no names: they are sines, one after the other.
    const named = modes.some((mode) => mode.name);
    const heads = ["Mode", "Frequency [Hz]", "Damping [%]", ...(named ? [SHAPE, "MAC"] : [])];
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
          h("tbody", null, modes.map((mode) => row(mode, named))),
        ),
      ),
      named && h("p", { class: "soft small" }, MEANING),
    );
  }
}

const SHAPE = "Shape";
const MEANING =
  "Shapes are recognised over points of the deck: bending is a half sine of one span, second " +
  "bending a full sine, torsion a half sine on one side against the other. The modal assurance " +
  "criterion (MAC) is 1 for equal shapes; a mode bears a name from 0.80 on.";

/**
 * @param {Mode} mode
 * @param {boolean} named
 */
function row(mode, named) {
  return h(
    "tr",
    { class: named && mode.name ? "named" : "" },
    h("th", { scope: "row" }, mode.number),
    h("td", null, mode.frequency.toFixed(2)),
    h("td", null, (mode.damping * 100).toFixed(2)),
    named && h("td", { class: "shape" }, mode.name || "–"),
    named && h("td", null, mode.name ? mode.assurance.toFixed(3) : "–"),
  );
}

customElements.define("tb-modes-table", ModesTable);
