// @ts-check
/** What is marked on the elevation: outputs, defects, lengths. */
import { s } from "../dom.js";

/** @typedef {import("../layout.js").Layout} Layout */
/** @typedef {import("../layout.js").Levels} Levels */

/**
 * @param {Layout["points"][number]} point
 * @param {number} index
 * @param {Levels} levels
 * @param {number} width of the drawing [m]
 */
export function output({ x, judged }, index, levels, width) {
  const words = `Output: mid-span ${index + 1}, x = ${+x.toFixed(2)} m${judged ? ", judged" : ""}`;
  return s("circle", { class: judged ? "point judged" : "point", cx: x, cy: levels.deck + levels.slab / 2, r: width / 165 }, s("title", null, words));
}

/**
 * Lengths of the spans below the ground, as on a drawing. Where spans are many, only their sum.
 *
 * @param {Layout} layout
 * @param {number} ground
 * @param {number} width
 */
export function lengths({ spans }, ground, width) {
  const size = width / 28;
  const y = ground + size * 0.55;
  const narrowest = Math.min(...spans.map(([from, to]) => to - from));
  /** @type {[number, number][]} */
  const parts = narrowest > 3.4 * size ? spans : [[0, spans[spans.length - 1][1]]];
  const ends = [...parts.map(([from]) => from), parts[parts.length - 1][1]];
  return s(
    "g",
    { class: "dimension", "font-size": size },
    s("path", { d: `M0 ${y}H${ends[ends.length - 1]}${ends.map((x) => `M${x} ${y - size / 3}v${(2 * size) / 3}`).join("")}` }),
    parts.map(([from, to]) => s("text", { x: (from + to) / 2, y: y + size * 1.1, "text-anchor": "middle" }, `${+(to - from).toFixed(2)} m`)),
  );
}

/** A bell upward, or a dip; far too high, as its amplitude is some millimetres. @param {Layout["defects"][number]} item */
export function defect({ position: x, amplitude, width }) {
  const half = Math.min(Math.max(width, 2.4), 12) / 2;
  const height = amplitude < 0 ? 0.9 : -0.9;
  return s(
    "g",
    { class: "defect" },
    s("path", { d: `M${x - half} 0 q${half * 0.5} 0 ${half * 0.7} ${height / 2} q${half * 0.3} ${height} ${half * 0.6} 0 q${half * 0.2} ${-height / 2} ${half * 0.7} ${-height / 2} Z` }),
    s("path", { class: "flag", d: `M${x} -0.7 V-5.2` }),
    s("circle", { cx: x, cy: -5.3, r: 0.5 }),
    s("title", null, `Defect at x = ${x} m, A = ${+(amplitude * 1000).toFixed(2)} mm`),
  );
}

/** How high the largest elevation of a profile is drawn. [m] */
const PROFILE = 0.9;

/**
 * A measured profile: its samples over the rail, far too high, between two flags.
 *
 * @param {NonNullable<ReturnType<typeof import("../irregularity-profile.js").stretchOf>>} item
 */
export function stretch({ from, to, words, paths }) {
  return s(
    "g",
    { class: "stretch" },
    paths.map((points, index) => s("path", { class: index ? "other" : null, d: `M${points.map(([x, r]) => `${x.toFixed(2)} ${(-PROFILE * r).toFixed(3)}`).join("L")}` })),
    s("path", { class: "flag", d: `M${from} -0.7V-5.4H${to}V-0.7` }),
    s("title", null, `Measured profile, ${words}`),
  );
}
