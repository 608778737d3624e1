// @ts-check
/** A train from the side with the load of each axle under it, to scale; wide, so it scrolls. */
import { axleGroups, axleLoads } from "../axle-loads.js";
import { h, s, show } from "../dom.js";
import { number } from "../format.js";
import { layoutOf } from "../layout.js";
import { trainParts } from "./elevation-train.js";

/** Drawn size of a metre. [px] */
const METRE = 9;
const MARGIN = 6;
const TOP = -5.2;
const BOTTOM = 4.6;

export class LibraryTrain extends HTMLElement {
  /** @param {any} train */
  set train(train) {
    const layout = layoutOf({ train });
    const loads = axleLoads(train);
    const axles = layout.axles.length ? layout.axles : layout.masses;
    if (!axles.length) {
      show(this, h("p", { class: "soft" }, "This train cannot be drawn: a name in its consist is none of its vehicle types."));
      return;
    }
    const back = Math.min(...axles, ...layout.cars.map((car) => car.back)) - MARGIN;
    const front = Math.max(...axles, ...layout.cars.map((car) => car.front)) + MARGIN;
    const groups = axleGroups(loads);
    const said = `${axles.length} axle${axles.length > 1 ? "s" : ""} over ${number(axles[0] - axles[axles.length - 1], 5)} m, ${number(total(loads) / 1000, 4)} t together.`;
    const picture = s(
      "svg",
      { viewBox: `${back} ${TOP} ${front - back} ${BOTTOM - TOP}`, class: "elevation library-train", role: "img", "aria-label": `Train from the side: ${said}` },
      s("line", { class: "rail", x1: back, x2: front, y1: 0, y2: 0 }),
      trainParts(layout),
      pairs(axles).map(({ x, first }) => loaded(x, loads[first])),
    );
    picture.setAttribute("width", String(Math.round((front - back) * METRE)));
    picture.setAttribute("height", String(Math.round((BOTTOM - TOP) * METRE)));
    show(
      this,
      h("div", { class: "scroll library-long", tabindex: "0", role: "region", "aria-label": "Train from the side, its head on the right" }, picture),
      h("p", { class: "soft small" }, said, axles.length > 1 ? " The head is on the right; the numbers are the loads of one axle in tonnes." : ""),
      groups.length > 0 && h("details", null, h("summary", null, "Axle loads"), table(groups, axles)),
    );
    const long = /** @type {HTMLElement} */ (this.querySelector(".library-long"));
    requestAnimationFrame(() => (long.scrollLeft = long.scrollWidth));
  }
}

/** @param {number[]} loads */
const total = (loads) => loads.reduce((sum, load) => sum + load, 0);

/**
 * Neighbouring axles of one bogie share a label.
 *
 * @param {number[]} axles
 */
function pairs(axles) {
  /** @type {{ x: number, first: number }[]} */
  const found = [];
  for (let index = 0; index < axles.length; index += 1) {
    const next = axles[index + 1];
    const isPair = next !== undefined && axles[index] - next < 4;
    found.push({ x: isPair ? (axles[index] + next) / 2 : axles[index], first: index });
    if (isPair) index += 1;
  }
  return found;
}

/**
 * @param {number} x
 * @param {number | undefined} load [kg]
 */
function loaded(x, load) {
  if (load === undefined) return null;
  return s(
    "g",
    { class: "axle-load" },
    s("path", { d: `M${x} 0.4v1.5m-0.35 -0.55l0.35 0.6l0.35 -0.6` }),
    s("text", { x, y: 3.5, "text-anchor": "middle" }, (load / 1000).toFixed(load < 10000 ? 2 : 1)),
  );
}

/**
 * @param {ReturnType<typeof axleGroups>} groups
 * @param {number[]} axles
 */
function table(groups, axles) {
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Axle loads" },
    h(
      "table",
      null,
      h("thead", null, h("tr", null, ["Axles", "behind the first [m]", "load of one [t]", "of one wheel [t]"].map((text) => h("th", { scope: "col" }, text)))),
      h(
        "tbody",
        null,
        groups.map(({ first, last, load }) =>
          h(
            "tr",
            null,
            h("th", { scope: "row" }, first === last ? first : `${first} to ${last}`),
            h("td", null, [first, ...(first === last ? [] : [last])].map((axle) => number(axles[0] - axles[axle - 1], 5)).join(" to ")),
            h("td", null, (load / 1000).toFixed(3)),
            h("td", null, (load / 2000).toFixed(3)),
          ),
        ),
      ),
    ),
  );
}

customElements.define("tb-library-train", LibraryTrain);
