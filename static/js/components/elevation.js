// @ts-check
/** The viaduct from the side with the train on it, drawn to scale from the study. */
import { s, show } from "../dom.js";
import { layoutOf } from "../layout.js";

/** @typedef {import("../types.js").Study} Study */
/** @typedef {import("../layout.js").Layout} Layout */

/** Heights for drawing only; rail level is 0, downward positive as in SVG. [m] */
const DECK = 0.7;
const SOFFIT = 2.5;
const GROUND = 7.2;
const ROOF = -4;
const MARGIN = 13;
/** Ground and rails go on beyond any frame. [m] */
const FAR = 300;

export class Elevation extends HTMLElement {
  /** @type {Study | null} */
  #study = null;
  /** @type {number | null} */
  #front = null;

  /** The study that is drawn. */
  get study() {
    return this.#study;
  }

  set study(study) {
    this.#study = study;
    this.#draw();
  }

  /** x of the first axle [m]; null: the train stands on the last span. @param {number | null} front */
  set front(front) {
    this.#front = front;
    this.#place();
  }

  #draw() {
    if (!this.#study) return;
    const layout = layoutOf(this.#study);
    const end = layout.spans[layout.spans.length - 1]?.[1] ?? 20;
    const margin = Math.max(MARGIN, (46 - end) / 2);
    const width = end + 2 * margin;
    const picture = s(
      "svg",
      {
        viewBox: `${-margin} -6.2 ${width} ${GROUND + 6.2}`,
        preserveAspectRatio: "xMidYMax meet",
        role: "img",
        "aria-label": describe(layout),
        class: "elevation",
      },
      ground(end, this.#study.track?.type !== "none"),
      layout.spans.map(([from, to]) => span(from, to, this.#study?.track?.type !== "none")),
      piers(layout),
      s("line", { class: "rail", x1: -FAR, x2: end + FAR, y1: 0, y2: 0 }),
      s("g", { class: "train" }, layout.cars.map(car), axles(layout), layout.masses.map(mass)),
      layout.defects.map(defect),
      layout.marked !== null && s("circle", { class: "point", cx: layout.marked, cy: DECK, r: 0.42 }),
    );
    show(this, picture);
    this.#place();
  }

  #place() {
    const train = this.querySelector(".train");
    if (!train || !this.#study) return;
    const spans = layoutOf(this.#study).spans;
    const end = spans[spans.length - 1]?.[1] ?? 20;
    const rest = this.#study.train?.type === "articulated" ? end - 3 : end * 0.42;
    train.setAttribute("transform", `translate(${(this.#front ?? rest).toFixed(3)} 0)`);
  }
}

/** @param {Layout} layout */
function describe(layout) {
  const lengths = layout.spans.map(([from, to]) => `${+(to - from).toFixed(2)} m`).join(", ");
  const load = layout.cars.length
    ? `a train of ${layout.cars.length} cars`
    : `${layout.masses.length} sprung mass${layout.masses.length > 1 ? "es" : ""}`;
  const defect = layout.defects.map((item) => `; defect at x = ${item.position} m`).join("");
  return `Elevation: spans of ${lengths}; ${load}${defect}.`;
}

/**
 * @param {number} end
 * @param {boolean} ballasted
 */
function ground(end, ballasted) {
  const left = `M${-FAR} ${ballasted ? DECK : 0.1} H-0.5 L-4.5 ${GROUND} H${-FAR} Z`;
  const right = `M${end + FAR} ${ballasted ? DECK : 0.1} H${end + 0.5} L${end + 4.5} ${GROUND} H${end + FAR} Z`;
  return s(
    "g",
    { class: "ground" },
    s("path", { d: left }),
    s("path", { d: right }),
    ballasted && s("rect", { class: "ballast", x: -FAR, y: 0.12, width: end + 2 * FAR, height: DECK - 0.12 }),
  );
}

/**
 * @param {number} from
 * @param {number} to
 * @param {boolean} ballasted otherwise the wheels roll on the beam itself
 */
function span(from, to, ballasted) {
  const top = ballasted ? DECK : 0.12;
  return s(
    "g",
    { class: "span" },
    s("rect", { class: "slab", x: from + 0.1, y: top, width: to - from - 0.2, height: 0.42 }),
    s("rect", { class: "beam", x: from + 0.25, y: top + 0.42, width: to - from - 0.5, height: SOFFIT - top - 0.42 }),
    [from + 0.8, to - 0.8].map((x) =>
      s("path", { class: "bearing", d: `M${x} ${SOFFIT} l0.42 0.5 h-0.84 Z` }),
    ),
  );
}

/** @param {Layout} layout */
function piers(layout) {
  return layout.spans.slice(1).map(([x]) =>
    s("path", {
      class: "pier",
      d: `M${x - 1.5} ${SOFFIT + 0.5} h3 v0.6 l-0.8 0.5 V${GROUND} h-1.4 V${SOFFIT + 1.6} l-0.8 -0.5 Z`,
    }),
  );
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

/** @param {number} x */
function mass(x) {
  return s(
    "g",
    { class: "car mass" },
    s("rect", { x: x - 1.5, y: ROOF - 0.3, width: 3, height: 1.9, rx: 0.35 }),
    s("path", {
      class: "spring",
      d: `M${x} ${ROOF + 1.6} v0.25 l-0.55 0.2 l1.1 0.35 l-1.1 0.35 l1.1 0.35 l-0.55 0.2 v0.2`,
    }),
    s("circle", { class: "wheel", cx: x, cy: -0.42, r: 0.42 }),
  );
}

/** @param {{ position: number, rail: string }} item */
function defect(item) {
  const x = item.position;
  return s(
    "g",
    { class: "defect" },
    s("path", { d: `M${x - 2} 0 q1 0 1.4 -0.5 q0.6 -0.8 1.2 0 q0.4 0.5 1.4 0 Z` }),
    s("path", { class: "flag", d: `M${x} -0.7 V-5.2` }),
    s("circle", { cx: x, cy: -5.3, r: 0.5 }),
  );
}

customElements.define("tb-elevation", Elevation);
