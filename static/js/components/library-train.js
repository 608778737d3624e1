// @ts-check
/** A train from the side with the load of each axle under it, to scale; wide, so it scrolls. */
import { GRAVITY, axleGroups, axleLabels, axleLoads } from "../axle-loads.js";
import { h, s, show } from "../dom.js";
import { number } from "../format.js";
import { layoutOf } from "../layout.js";
import { trainParts } from "./elevation-train.js";

/** Drawn size of a metre. [px] */
const METRE = 9;
const MARGIN = 6;
const TOP = -5.2;
const BOTTOM = 4.6;
/** Labels of neighbours that weigh different things stand in two rows, so far apart. [m] */
const LOWER = 1.9;

export class LibraryTrain extends HTMLElement {
  /** @param {any} train */
  set train(train) {
    const layout = layoutOf({ train });
    const loads = axleLoads(train);
    const axles = layout.axles.length ? layout.axles : layout.masses;
    if (!axles.length) {
      const why = train?.type === "axle_table" ? "no axle has a place" : "a name in its consist is none of its vehicle types";
      show(this, h("p", { class: "soft" }, `This train cannot be drawn: ${why}.`));
      return;
    }
    const unit = train?.type === "axle_table" ? KILONEWTONS : TONNES;
    const labels = axleLabels(axles, loads);
    const bottom = BOTTOM + (labels.some(({ lower }) => lower) ? LOWER : 0);
    const back = Math.min(...axles, ...layout.cars.map((car) => car.back)) - MARGIN;
    const front = Math.max(...axles, ...layout.cars.map((car) => car.front)) + MARGIN;
    const groups = axleGroups(loads);
    const said = `${axles.length} axle${axles.length > 1 ? "s" : ""} over ${number(axles[0] - axles[axles.length - 1], 6)} m, ${number(total(loads) / 1000, 4)} t together.`;
    const picture = s(
      "svg",
      { viewBox: `${back} ${TOP} ${front - back} ${bottom - TOP}`, class: "elevation library-train", role: "img", "aria-label": `Train from the side: ${said}` },
      s("line", { class: "rail", x1: back, x2: front, y1: 0, y2: 0 }),
      trainParts(layout),
      labels.map((label) => loaded(label, unit)),
    );
    picture.setAttribute("width", String(Math.round((front - back) * METRE)));
    picture.setAttribute("height", String(Math.round((bottom - TOP) * METRE)));
    show(
      this,
      h("div", { class: "scroll library-long", tabindex: "0", role: "region", "aria-label": "Train from the side, its head on the right" }, picture),
      h("p", { class: "soft small" }, said, axles.length > 1 ? ` The head is on the right; the numbers are the loads of one axle in ${unit.words}.` : ""),
      groups.length > 0 && h("details", null, h("summary", null, "Axle loads"), table(groups, axles, unit)),
    );
    const long = /** @type {HTMLElement} */ (this.querySelector(".library-long"));
    requestAnimationFrame(() => (long.scrollLeft = long.scrollWidth));
  }
}

/** @typedef {import("../axle-loads.js").Label} Label */
/** @typedef {{ words: string, symbol: string, short: (load: number) => string, long: (load: number) => string }} LoadUnit */

/** @type {LoadUnit} */
const TONNES = { words: "tonnes", symbol: "t", short: (load) => (load / 1000).toFixed(load < 10000 ? 2 : 1), long: (load) => (load / 1000).toFixed(3) };
/** As tables of axles give them. @type {LoadUnit} */
const KILONEWTONS = { words: "kilonewtons", symbol: "kN", short: (load) => number((load * GRAVITY) / 1000, 4), long: (load) => number((load * GRAVITY) / 1000, 6) };

/** @param {number[]} loads */
const total = (loads) => loads.reduce((sum, load) => sum + load, 0);

/**
 * @param {Label} label
 * @param {LoadUnit} unit
 */
function loaded({ x, load, lower }, unit) {
  if (load === undefined) return null;
  return s(
    "g",
    { class: "axle-load" },
    s("path", { d: `M${x} 0.4v1.5m-0.35 -0.55l0.35 0.6l0.35 -0.6` }),
    s("text", { x, y: 3.5 + (lower ? LOWER : 0), "text-anchor": "middle" }, unit.short(load)),
  );
}

/**
 * @param {ReturnType<typeof axleGroups>} groups
 * @param {number[]} axles
 * @param {LoadUnit} unit
 */
function table(groups, axles, unit) {
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Axle loads" },
    h(
      "table",
      null,
      h("thead", null, h("tr", null, ["Axles", "behind the first [m]", `load of one [${unit.symbol}]`, `of one wheel [${unit.symbol}]`].map((text) => h("th", { scope: "col" }, text)))),
      h(
        "tbody",
        null,
        groups.map(({ first, last, load }) =>
          h(
            "tr",
            null,
            h("th", { scope: "row" }, first === last ? first : `${first} to ${last}`),
            h("td", null, [first, ...(first === last ? [] : [last])].map((axle) => number(axles[0] - axles[axle - 1], 6)).join(" to ")),
            h("td", null, unit.long(load)),
            h("td", null, unit.long(load / 2)),
          ),
        ),
      ),
    ),
  );
}

customElements.define("tb-library-train", LibraryTrain);
