// @ts-check
/** How passengers feel the crossing: peak of each car against the levels of comfort. */
import { h, show } from "../dom.js";
import { number } from "../format.js";

/** @typedef {import("../types.js").Comfort} Comfort */

export class ComfortTable extends HTMLElement {
  /** @param {Comfort} comfort */
  set comfort({ clause, levels, cars, worst }) {
    this.classList.add("card", "sheet");
    const limits = levels.map(({ name, limit }) => `${name} ${number(limit, 3)}`).join(", ");
    show(
      this,
      h("h2", null, `Comfort: ${worst.level}`),
      h("p", { class: "soft" }, `Greatest vertical acceleration in the coaches ${number(worst.peak, 3)} m/s², ${worst.name}, at ${worst.time.toFixed(3)} s. Levels of ${clause}: ${limits} m/s².`),
      h(
        "details",
        null,
        h("summary", null, "Every car"),
        h(
          "div",
          { class: "scroll", tabindex: 0, role: "region", "aria-label": "Comfort of every car" },
          h(
            "table",
            null,
            h("thead", null, h("tr", null, ["Car", "Peak [m/s²]", "at t [s]", "Comfort"].map((text) => h("th", { scope: "col" }, text)))),
            h(
              "tbody",
              null,
              cars.map((car) =>
                h("tr", null, h("th", { scope: "row" }, car.name), h("td", null, number(car.peak, 3)), h("td", null, car.time.toFixed(3)), h("td", null, car.level)),
              ),
            ),
          ),
        ),
      ),
    );
  }
}

customElements.define("tb-comfort-table", ComfortTable);
