// @ts-check
/** The viaduct cut across with the train on it, drawn to scale; looking in the train's way. */
import { s, show } from "../dom.js";
import { sectionOf } from "../section.js";

/** @typedef {import("../section.js").Section} Section */

const MARGIN = 0.5;
/** Room below the beam for the dimension. [m] */
const BELOW = 1.35;
const TURNS = 4;

export class CrossSection extends HTMLElement {
  /** Whether the train stands on it. Say so before the study. */
  loaded = true;

  /** @param {import("../types.js").Study} study */
  set study(study) {
    const whole = sectionOf(study, this.loaded);
    const section = this.loaded ? whole : { ...whole, points: [], defects: [] }; // no load, no histories
    const { width, top } = section.size;
    const half = Math.max(width, 4.4) / 2 + MARGIN;
    show(
      this,
      s(
        "svg",
        { viewBox: `${-half} ${-top - 0.2} ${2 * half + 1.1} ${top + 0.2 + BELOW}`, role: "img", "aria-label": words(section), class: "elevation section-drawing" },
        section.shapes.map(({ part, corners }) => s("path", { class: part, d: path(corners) })),
        section.springs.map(({ from, to }) => s("path", { class: "spring", d: coil(from, to) })),
        section.defects.map(defect),
        section.points.map(({ y, z, name }) => s("circle", { class: "point", cx: -y, cy: -z, r: 0.11 }, s("title", null, `Output: mid-span, ${name}`))),
        dimensions(section),
      ),
    );
  }
}

/** @param {Section} section */
function words({ words: text, points, defects }) {
  const marked = defects.map(({ y }) => (y > 0 ? "left" : y < 0 ? "right" : "only") + " rail").join(" and ");
  const read = points.length ? ` Output points: ${points.map((point) => point.name).join(", ")}.` : "";
  return `${text}${read}${marked ? ` Defect on the ${marked}.` : ""}`;
}

/** The left is drawn on the left. @param {[number, number][]} corners */
function path(corners) {
  return `M${corners.map(([y, z]) => `${(-y).toFixed(4)} ${(-z).toFixed(4)}`).join("L")}Z`;
}

/** @param {[number, number]} from @param {[number, number]} to */
function coil([y, bottom], [, top]) {
  const step = (top - bottom) / (TURNS + 1);
  const inner = Array.from({ length: TURNS }, (_, index) => `L${(-y + (index % 2 ? -0.09 : 0.09)).toFixed(3)} ${-(bottom + (index + 1) * step)}`);
  return `M${-y} ${-bottom}${inner.join("")}L${-y} ${-top}`;
}

/** @param {{ y: number, z: number, dip: boolean }} item */
function defect({ y, z, dip }) {
  const tip = dip ? 0.02 : 0.42;
  return s("path", { class: "flaw", d: `M${-y - 0.2} ${-z - (dip ? 0.42 : 0.02)}h0.4L${-y} ${-z - tip}Z` }, s("title", null, "Defect of this rail"));
}

/** Width of the deck and depth of the beam. @param {Section} section */
function dimensions({ size }) {
  const half = size.width / 2;
  const x = half + 0.45;
  return s(
    "g",
    { class: "dimension" },
    s("path", { d: `M${-half} 1.05H${half}M${-half} 0.91v0.28M${half} 0.91v0.28M${x} 0V${-size.depth}M${x - 0.14} 0h0.28M${x - 0.14} ${-size.depth}h0.28` }),
    s("text", { x: 0, y: 0.86, "text-anchor": "middle" }, `${+size.width.toFixed(2)} m`),
    s("text", { x: 0, y: 0, "text-anchor": "middle", transform: `translate(${x + 0.55} ${-size.depth / 2}) rotate(-90)` }, `${+size.depth.toFixed(2)} m`),
  );
}

customElements.define("tb-cross-section", CrossSection);
