// @ts-check
/** The viaduct from the side with the train on it, drawn to scale from the study. */
import { s, show } from "../dom.js";
import { layoutOf } from "../layout.js";
import { stretchOf } from "../irregularity-profile.js";
import { defect, lengths, output, stretch } from "./elevation-marks.js";
import { trainParts } from "./elevation-train.js";

/** @typedef {import("../types.js").Study} Study */
/** @typedef {import("../layout.js").Layout} Layout */
/** @typedef {import("../layout.js").Levels} Levels */

/** Heights for drawing only; rail level is 0, downward positive as in SVG. [m] */
const GROUND = 7.2;
const MARGIN = 13;
/** Of a track alone, so much is drawn. [m] */
const BAYS = 24;
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

  /** Whether lengths are written; small drawings do without. */
  labelled = false;
  /** What is drawn: a train on its viaduct, or one of them. @type {"crossing" | "viaduct" | "train" | "track"} */
  scope = "crossing";

  #draw() {
    if (!this.#study) return;
    const layout = layoutOf(this.#study);
    const { levels } = layout;
    const ground = Math.max(GROUND, levels.soffit + 3);
    const end = this.scope === "track" ? BAYS : layout.spans[layout.spans.length - 1][1];
    const margin = this.scope === "track" ? 1 : Math.max(MARGIN, (46 - end) / 2);
    const width = end + 2 * margin;
    const height = ground + 6.2 + (this.labelled ? width * 0.07 : 0);
    const profile = this.scope === "crossing" ? stretchOf(this.#study.irregularity) : null;
    const measured = profile ? ` Measured profile of ${profile.words}` : "";
    const [bridge, load] = [this.scope === "crossing" || this.scope === "viaduct", this.scope === "crossing" || this.scope === "train"];
    const picture = s(
      "svg",
      { viewBox: `${-margin} -6.2 ${width} ${height}`, preserveAspectRatio: "xMidYMax meet", role: "img", "aria-label": describe(layout, this.scope, this.#study.train?.type) + measured, class: "elevation" },
      bridge ? [banks(end, levels, ground), layout.spans.map(([from, to]) => span(from, to, levels)), piers(layout, ground)] : bed(end, ground),
      s("line", { class: "rail", x1: -FAR, x2: end + FAR, y1: 0, y2: 0 }),
      load && s("g", { class: "train" }, trainParts(layout)),
      profile && stretch(profile),
      this.scope === "crossing" && [layout.defects.map(defect), layout.points.map((point, index) => output(point, index, levels, width))],
      this.labelled && bridge && lengths(layout, ground, width),
    );
    show(this, picture);
    this.#place();
  }

  #place() {
    const train = this.querySelector(".train");
    if (!train || !this.#study) return;
    const spans = layoutOf(this.#study).spans;
    const end = spans[spans.length - 1]?.[1] ?? 20;
    const rest = this.#study.train?.type === "sprung_masses" ? end * 0.42 : end - 3;
    train.setAttribute("transform", `translate(${(this.#front ?? rest).toFixed(3)} 0)`);
  }
}

/**
 * @param {Layout} layout
 * @param {Elevation["scope"]} scope
 * @param {string} kind of train
 */
function describe(layout, scope, kind) {
  const lengths = `spans of ${layout.spans.map(([from, to]) => `${+(to - from).toFixed(2)} m`).join(", ")}`;
  const one = layout.masses.length === 1;
  const masses = kind === "axle_table" ? `axle${one ? "" : "s"}` : `sprung mass${one ? "" : "es"}`;
  const load = layout.cars.length ? `a train of ${layout.cars.length} cars` : `${layout.masses.length} ${masses}`;
  const defect = layout.defects.map((item) => `; defect at x = ${item.position} m`).join("");
  const words = { crossing: `${lengths}; ${load}${defect}`, viaduct: lengths, train: load, track: "track on its bed" };
  return `Elevation: ${words[scope]}.`;
}

/**
 * Track on the ground, without a viaduct.
 *
 * @param {number} end
 * @param {number} ground
 */
function bed(end, ground) {
  return s(
    "g",
    { class: "ground" },
    s("path", { d: `M${-FAR} 0.9 H${end + FAR} V${ground} H${-FAR} Z` }),
    s("rect", { class: "ballast", x: -FAR, y: 0.25, width: end + 2 * FAR, height: 0.65 }),
    s("line", { class: "sleepers", x1: -FAR, x2: end + FAR, y1: 0.24, y2: 0.24 }),
  );
}

/**
 * @param {number} end
 * @param {Levels} levels
 * @param {number} ground
 */
function banks(end, { deck, ballasted }, ground) {
  const left = `M${-FAR} ${deck} H-0.5 L-4.5 ${ground} H${-FAR} Z`;
  const right = `M${end + FAR} ${deck} H${end + 0.5} L${end + 4.5} ${ground} H${end + FAR} Z`;
  return s(
    "g",
    { class: "ground" },
    s("path", { d: left }),
    s("path", { d: right }),
    ballasted && s("rect", { class: "ballast", x: -FAR, y: 0.12, width: end + 2 * FAR, height: Math.max(deck - 0.12, 0.01) }),
  );
}

/**
 * @param {number} from
 * @param {number} to
 * @param {Levels} levels
 */
function span(from, to, { deck, slab, soffit }) {
  const length = to - from;
  return s(
    "g",
    { class: "span" },
    s("rect", { class: "slab", x: from + 0.1, y: deck, width: Math.max(length - 0.2, 0.1), height: slab }),
    s("rect", { class: "beam", x: from + 0.25, y: deck + slab, width: Math.max(length - 0.5, 0.1), height: Math.max(soffit - deck - slab, 0.05) }),
    [from + 0.8, to - 0.8].map((x) => s("path", { class: "bearing", d: `M${x} ${soffit} l0.42 0.5 h-0.84 Z` })),
  );
}

/**
 * @param {Layout} layout
 * @param {number} ground
 */
function piers({ spans, levels: { soffit } }, ground) {
  return spans.slice(1).map(([x]) =>
    s("path", {
      class: "pier",
      d: `M${x - 1.5} ${soffit + 0.5} h3 v0.6 l-0.8 0.5 V${ground} h-1.4 V${soffit + 1.6} l-0.8 -0.5 Z`,
    }),
  );
}

customElements.define("tb-elevation", Elevation);
