// @ts-check
/**
 * Where the parts of a study lie along the track, for drawing: spans, cars, axles, defects. Pure.
 *
 * The solver's own layout decides what is computed; this one only draws it.
 */

/** @typedef {import("./types.js").Study} Study */
/** @typedef {{ front: number, back: number, power: boolean }} Car extents relative to the first axle [m] */
/** Depths below the top of the rail. [m] @typedef {{ deck: number, slab: number, soffit: number, ballasted: boolean }} Levels */
/**
 * @typedef {object} Layout
 * @property {[number, number][]} spans beginning and end of each span [m]
 * @property {Car[]} cars
 * @property {number[]} axles x of each axle less the first [m]
 * @property {number[]} masses x of each sprung mass, or each axle of a table, less the first [m]
 * @property {number} box length of the box that stands for such a mass [m]
 * @property {{ position: number, rail: string, amplitude: number, width: number }[]} defects width is that of the drawn bell [m]
 * @property {{ x: number, judged: boolean }[]} points the mid-spans, where histories are recorded
 * @property {Levels} levels
 */

/** A car's body reaches this far beyond its own outer bogie. [m] */
const OVERHANG = 3.6;
/** Half the gap between two cars. [m] */
const GAP = 0.2;
/** Height of a 60E1 rail. [m] */
export const RAIL_HEIGHT = 0.172;
/** Where wheels roll on the beam itself, its top lies this far below the drawn line. [m] */
const BEAM_TOP = 0.12;
/** The box of a sprung mass, the part of the way to the next one that it fills, and the shortest. [m, 1, m] */
const [BOX, FILLED, LEAST_BOX] = [3, 0.7, 0.3];
/** A beam whose depth nobody states is drawn with this part of its span. */
const SLENDERNESS = 14;

/**
 * @param {Study} study
 * @returns {Layout}
 */
export function layoutOf(study) {
  const spans = spansOf(study.viaduct ?? {});
  const train = study.train ?? {};
  const articulated = train.type === "articulated";
  return {
    spans,
    ...(articulated ? carsOf(train) : { cars: [], axles: [] }),
    ...(articulated ? { masses: [], box: BOX } : massesOf(train)),
    defects: defectsOf(study.irregularity),
    points: pointsOf(spans, study.viaduct),
    levels: levelsOf(study),
  };
}

/**
 * The middle of each span. A deck is judged where its neighbours are modelled too, a lone one as it
 * stands; plain beams are not judged.
 *
 * @param {[number, number][]} spans
 * @param {any} viaduct
 */
function pointsOf(spans, viaduct) {
  const last = spans.length - 1;
  return spans.map(([from, to], index) => ({
    x: (from + to) / 2,
    judged: viaduct?.type !== "beam" && (last < 2 || (index > 0 && index < last)),
  }));
}

/**
 * A number that can be drawn.
 *
 * @param {any} value
 * @param {number} standard where there is none
 * @param {number} [most]
 */
export function drawable(value, standard, most = 50) {
  return typeof value === "number" && value > 0 ? Math.min(value, most) : standard;
}

/**
 * @param {Study} study
 * @returns {Levels}
 */
export function levelsOf({ viaduct = {}, track = {} }) {
  if (viaduct.type === "beam" || viaduct.slab_level === undefined) {
    const span = Math.max(...spansOf(viaduct).map(([from, to]) => to - from));
    return { deck: BEAM_TOP, slab: 0.35, soffit: BEAM_TOP + Math.min(Math.max(span / SLENDERNESS, 0.8), 3.2), ballasted: track.type !== "none" };
  }
  const ballasted = track.type !== "none";
  const deck = ballasted ? drawable(track.ballast_depth, 0.313, 2) + drawable(track.sleeper_height, 0.23, 1) + RAIL_HEIGHT : BEAM_TOP;
  const slab = drawable(viaduct.slab_thickness, 0.27, 2);
  return { deck, slab, soffit: deck + drawable(viaduct.slab_level, 1.335, 10) + slab / 2, ballasted };
}

/**
 * @param {any} viaduct
 * @returns {[number, number][]}
 */
function spansOf(viaduct) {
  const lengths = viaduct.spans ?? viaduct.properties?.spans ?? [viaduct.span ?? viaduct.length ?? 20];
  /** @type {[number, number][]} */
  const spans = [];
  for (const length of Array.isArray(lengths) ? lengths : [lengths]) {
    const start = spans.length ? spans[spans.length - 1][1] : 0;
    if (Number(length) > 0) spans.push([start, start + Number(length)]);
  }
  return spans.length ? spans : [[0, 20]];
}

/** @param {any} train */
function massesOf(train) {
  if (train.type === "axle_table") return tableOf(train);
  const count = Math.round(drawable(train.count, 1, 40));
  return { masses: Array.from({ length: count }, (_, index) => -index * drawable(train.spacing, 20, 1000) || 0), box: BOX };
}

/**
 * Axles of a table, each box short enough to stand beside its neighbours.
 *
 * @param {any} train
 */
function tableOf(train) {
  const places = axleRows(train).map((axle) => Number(axle.position));
  const gaps = places.slice(1).map((place, index) => place - places[index]).filter((gap) => gap > 0);
  return { masses: places.map((place) => places[0] - place), box: Math.max(Math.min(BOX, ...gaps.map((gap) => FILLED * gap)), LEAST_BOX) };
}

/**
 * Axles of a table that have a place: what is being typed may have none yet.
 *
 * @param {any} train
 * @returns {any[]}
 */
export function axleRows(train) {
  return Array.isArray(train?.axles) ? train.axles.filter((/** @type {any} */ axle) => Number.isFinite(axle?.position)) : [];
}

/** @param {any} irregularity */
function defectsOf(irregularity) {
  if (!irregularity || !Number.isFinite(irregularity.position)) return [];
  return [
    {
      position: irregularity.position,
      rail: irregularity.rail ?? "both",
      amplitude: Number(irregularity.amplitude) || 0,
      width: 6 / drawable(irregularity.wave_number, 1.5, 20),
    },
  ];
}

/**
 * @param {any} train
 * @returns {{ cars: Car[], axles: number[] }}
 */
function carsOf(train) {
  const types = new Map((Array.isArray(train.vehicle_types) ? train.vehicle_types : []).map((/** @type {any} */ type) => [type.name, type]));
  const names = Array.isArray(train.consist) ? train.consist : [];
  const consist = names.map((/** @type {string} */ name) => types.get(name));
  if (!consist.length || consist.some((/** @type {any} */ type) => !type)) return { cars: [], axles: [] };
  /** @type {number[]} */
  const bogies = [];
  /** @type {Car[]} */
  const cars = [];
  const half = (train.bogie_gap ?? 6) / 2;
  let shared = false;
  consist.forEach((/** @type {any} */ type, /** @type {number} */ index) => {
    const leading = index < consist.length / 2;
    if (!shared) bogies.push(bogies.length ? bogies[bogies.length - 1] - (train.bogie_gap ?? 6) : 0);
    const first = bogies[bogies.length - 1];
    const second = first - type.leading_distance - type.trailing_distance;
    bogies.push(second);
    const both = sharesBack(type, leading);
    cars.push({
      front: first + (shared ? -GAP : index ? half - GAP : OVERHANG),
      back: second - (both ? -GAP : index + 1 < consist.length ? half - GAP : OVERHANG),
      power: type.articulation === "none",
    });
    shared = both;
  });
  const wheel = (consist[0].wheelbase ?? 3) / 2;
  const axles = bogies.flatMap((bogie) => [bogie + wheel, bogie - wheel]);
  const move = -axles[0];
  return {
    cars: cars.map((car) => ({ ...car, front: car.front + move, back: car.back + move })),
    axles: axles.map((axle) => axle + move),
  };
}

/**
 * Whether a car stands on one bogie with the car behind it.
 *
 * @param {any} car
 * @param {boolean} leading whether it is in the first half of the train
 */
export function sharesBack(car, leading) {
  return car.articulation === "both_ends" || (car.articulation === "trailing_end" && leading);
}
