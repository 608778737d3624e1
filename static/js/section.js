// @ts-check
/**
 * The viaduct cut across, with the train on it, for drawing. Pure.
 *
 * y to the left, z upward from the underside of the beam, as in the solver. [m]
 */
import { drawable, levelsOf, RAIL_HEIGHT } from "./layout.js";

/** @typedef {import("./types.js").Study} Study */
/** @typedef {{ part: string, corners: [number, number][] }} Shape */
/** @typedef {{ part: string, from: [number, number], to: [number, number] }} Line */
/**
 * @typedef {object} Section
 * @property {Shape[]} shapes from the bottom to the top
 * @property {Line[]} springs
 * @property {{ y: number, z: number, name: string }[]} points where histories are recorded
 * @property {{ y: number, z: number, dip: boolean }[]} defects on the heads of the rails that have one
 * @property {{ width: number, depth: number, rail: number, top: number }} size depth of the beam, levels of rail and roof
 * @property {string} words
 */

const WHEEL_RADIUS = 0.46;
const WHEEL_WIDTH = 0.135;
/** Of a carbody, for drawing: half its width, its floor and its roof above the rail. [m] */
const BODY = { half: 1.45, floor: 1.32, roof: 3.75 };

/**
 * @param {Study} study
 * @param {boolean} [loaded] whether the train stands on it, with the marks of a crossing
 * @returns {Section}
 */
export function sectionOf(study, loaded = true) {
  const { viaduct = {}, track = {}, train = {}, irregularity = {} } = study;
  const plain = viaduct.type === "beam" || viaduct.slab_level === undefined;
  const levels = levelsOf(study);
  const rail = levels.soffit;
  const deck = plain ? beam(viaduct, rail - levels.deck) : girder(viaduct);
  const sides = plain ? [0] : [1, -1].map((side) => side * drawable(track.rail_position, 0.7175, 1.2));
  const laid = levels.ballasted ? ballast(track, rail - levels.deck, sides) : [];
  const load = !loaded ? { shapes: [], springs: [] } : train.type === "articulated" ? car(train, rail) : mass(sides, rail);
  return {
    shapes: [...deck.shapes, ...laid, ...load.shapes],
    springs: load.springs,
    points: !loaded ? [] : ["axis", "left rail", "right rail"].slice(0, plain ? 1 : 3).map((name, index) => ({ name, y: [0, sides[0], sides[1]][index], z: deck.points })),
    defects: loaded ? defects(irregularity, sides, rail) : [],
    size: { width: deck.width, depth: rail - levels.deck, rail, top: rail + (!loaded ? 0.6 : train.type === "articulated" ? BODY.roof : 3.2) },
    words: `Cross-section: deck ${+deck.width.toFixed(2)} m wide, beam ${+(rail - levels.deck).toFixed(2)} m deep.`,
  };
}

/**
 * @param {string} part
 * @param {number} left
 * @param {number} right
 * @param {number} bottom
 * @param {number} top
 * @returns {Shape}
 */
function box(part, left, right, bottom, top) {
  return { part, corners: [[left, bottom], [right, bottom], [right, top], [left, top]] }; // prettier-ignore
}

/**
 * The same thing on both sides of the axis.
 *
 * @param {string} part
 * @param {number} middle
 * @param {number} thickness
 * @param {number} bottom
 * @param {number} top
 */
function pair(part, middle, thickness, bottom, top) {
  return [1, -1].map((side) => box(part, side * middle - thickness / 2, side * middle + thickness / 2, bottom, top));
}

/** @param {any} viaduct */
function girder(viaduct) {
  const width = drawable(viaduct.slab_width, 7.2, 20);
  const thickness = drawable(viaduct.slab_thickness, 0.27, 2);
  const level = drawable(viaduct.slab_level, 1.335, 10);
  const web = drawable(viaduct.web_position, 1.55, 9);
  const webThickness = drawable(viaduct.web_thickness, 0.2, 2);
  const floor = drawable(viaduct.bottom_thickness, 0.18, 2);
  const bearing = drawable(viaduct.bearing_position, 1.55, 9);
  return {
    width,
    points: level,
    shapes: [
      ...[1, -1].map((side) => ({ part: "bearing", corners: triangle(side * bearing) })),
      box("beam", -web - webThickness / 2, web + webThickness / 2, 0, floor),
      ...pair("beam", web, webThickness, floor, level - thickness / 2),
      box("slab", -width / 2, width / 2, level - thickness / 2, level + thickness / 2),
      ...pair("slab", drawable(viaduct.wall_position, 2.15, 9.9), drawable(viaduct.wall_thickness, 0.25, 1), level + thickness / 2, level + drawable(viaduct.wall_height, 0.7, 3)),
    ],
  };
}

/** @param {number} y @returns {[number, number][]} */
const triangle = (y) => [[y, 0], [y + 0.22, -0.26], [y - 0.22, -0.26]]; // prettier-ignore

/**
 * @param {any} viaduct
 * @param {number} depth
 */
function beam(viaduct, depth) {
  const width = drawable(viaduct.width, 4, 50);
  return { width, points: depth, shapes: [{ part: "bearing", corners: triangle(0) }, box("beam", -width / 2, width / 2, 0, depth)] };
}

/**
 * @param {any} track
 * @param {number} base top of the slab
 * @param {number[]} sides
 * @returns {Shape[]}
 */
function ballast(track, base, sides) {
  const bed = base + drawable(track.ballast_depth, 0.313, 2);
  const top = bed + drawable(track.sleeper_height, 0.23, 1);
  const half = drawable(track.ballast_width, 4.3, 10) / 2;
  const [long, short] = [drawable(track.sleeper_length, 2.6, 4) / 2, drawable(track.sleeper_top_length, 2.55, 4) / 2];
  return [
    box("ballast", -half, half, base, bed),
    { part: "sleeper", corners: [[-long, bed], [long, bed], [short, top], [-short, top]] },
    ...sides.flatMap((y) => [
      box("rail", y - 0.075, y + 0.075, top, top + 0.03),
      box("rail", y - 0.012, y + 0.012, top + 0.03, top + 0.12),
      box("rail", y - 0.036, y + 0.036, top + 0.12, top + RAIL_HEIGHT),
    ]),
  ]; // prettier-ignore
}

/**
 * @param {any} train
 * @param {number} rail
 * @returns {{ shapes: Shape[], springs: Line[] }}
 */
function car(train, rail) {
  const [type = {}] = Array.isArray(train.vehicle_types) ? train.vehicle_types : [];
  const wheel = drawable(train.wheel_lateral_distance, 1.435, 3) / 2;
  const primary = drawable(type.primary_spacing, 2, 4) / 2;
  const secondary = drawable(type.secondary_spacing, 2.46, 4) / 2;
  const [frame, floor, roof] = [rail + 0.78, rail + BODY.floor, rail + BODY.roof];
  const { half } = BODY;
  /** @type {[number, number][]} */
  const body = [[-half, floor + 0.35], [-half + 0.3, floor], [half - 0.3, floor], [half, floor + 0.35], [half, floor + 1.1], [half - 0.18, roof - 0.45], [half - 0.6, roof], [0.6 - half, roof], [0.18 - half, roof - 0.45], [-half, floor + 1.1]]; // prettier-ignore
  return {
    shapes: [
      box("axle", -primary - 0.12, primary + 0.12, rail + WHEEL_RADIUS - 0.08, rail + WHEEL_RADIUS + 0.08),
      ...pair("wheel", wheel, WHEEL_WIDTH, rail, rail + 2 * WHEEL_RADIUS),
      box("bogie", -secondary - 0.12, secondary + 0.12, frame, frame + 0.2),
      { part: "body", corners: body },
      box("windows", -half + 0.02, -half + 0.12, floor + 0.85, floor + 1.5),
      box("windows", half - 0.12, half - 0.02, floor + 0.85, floor + 1.5),
    ],
    springs: [
      ...[primary, -primary].map((y) => spring(y, rail + WHEEL_RADIUS, frame)),
      ...[secondary, -secondary].map((y) => spring(y, frame + 0.2, floor)),
    ],
  };
}

/**
 * @param {number[]} sides
 * @param {number} rail
 * @returns {{ shapes: Shape[], springs: Line[] }}
 */
function mass(sides, rail) {
  const width = sides.length > 1 ? 1.1 : 0.7;
  return {
    shapes: [
      ...sides.map((y) => box("wheel", y - WHEEL_WIDTH / 2, y + WHEEL_WIDTH / 2, rail, rail + 2 * WHEEL_RADIUS)),
      box("body", -width, width, rail + 1.75, rail + 2.85),
    ],
    springs: sides.map((y) => spring(y, rail + 2 * WHEEL_RADIUS, rail + 1.75)),
  };
}

/** @param {number} y @param {number} bottom @param {number} top @returns {Line} */
const spring = (y, bottom, top) => ({ part: "spring", from: [y, bottom], to: [y, top] });

/**
 * @param {any} irregularity
 * @param {number[]} sides left first
 * @param {number} rail
 */
function defects(irregularity, sides, rail) {
  if (!Number.isFinite(irregularity.position)) return [];
  const dip = Number(irregularity.amplitude) < 0;
  const named = { left: sides.slice(0, 1), right: sides.slice(-1) };
  const own = named[/** @type {"left" | "right"} */ (irregularity.rail)] ?? sides;
  return own.map((y) => ({ y, z: rail, dip }));
}
