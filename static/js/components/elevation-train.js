// @ts-check
/** A train from the side, for the elevation. */
import { s } from "../dom.js";

/** @typedef {import("../layout.js").Layout} Layout */

/** Height for drawing only; the rail is 0, downward positive. [m] */
const ROOF = -4;

/** @param {Layout} layout */
export function trainParts(layout) {
  return [...layout.cars.map(car), ...axles(layout), ...layout.masses.map((x) => mass(x, layout.box))];
}

/**
 * @param {import("../layout.js").Car} item
 * @param {number} index
 * @param {import("../layout.js").Car[]} all
 */
function car(item, index, all) {
  const { front, back } = item;
  const nose = index === 0;
  const tail = index === all.length - 1;
  const right = nose
    ? `H${front - 5.2} C${front - 2} ${ROOF} ${front - 0.3} ${ROOF + 2} ${front} -0.9`
    : `H${front - 0.35} q0.25 0 0.25 0.3 V-0.9`;
  const left = tail
    ? `H${back} C${back + 0.3} ${ROOF + 2} ${back + 2} ${ROOF} ${back + 5.2} ${ROOF}`
    : `H${back + 0.1} V${ROOF + 0.3} q0 -0.3 0.25 -0.3`;
  const start = tail ? back + 5.2 : back + 0.35;
  return s(
    "g",
    { class: item.power ? "car power" : "car" },
    s("path", { d: `M${start} ${ROOF} ${right} ${left} Z` }),
    s("rect", {
      class: "windows",
      x: back + (tail ? 6.4 : 1.1),
      y: ROOF + 0.85,
      width: Math.max(front - back - (nose || tail ? 8 : 2.2), 0.1),
      height: 0.85,
      rx: 0.3,
    }),
  );
}

/** @param {Layout} layout */
function axles(layout) {
  return layout.axles.map((x) => s("circle", { class: "wheel", cx: x, cy: -0.46, r: 0.46 }));
}

/**
 * @param {number} x
 * @param {number} box length of the drawn mass [m]
 */
function mass(x, box) {
  const half = Math.min(0.55, box / 3);
  return s(
    "g",
    { class: "car mass" },
    s("rect", { x: x - box / 2, y: ROOF - 0.3, width: box, height: 1.9, rx: 0.35 }),
    s("path", {
      class: "spring",
      d: `M${x} ${ROOF + 1.6} v0.25 l${-half} 0.2 l${2 * half} 0.35 l${-2 * half} 0.35 l${2 * half} 0.35 l${-half} 0.2 v0.2`,
    }),
    s("circle", { class: "wheel", cx: x, cy: -0.42, r: 0.42 }),
  );
}
