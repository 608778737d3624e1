// @ts-check
/**
 * Where the parts of a study lie along the track, for drawing: spans, cars, axles, defects. Pure.
 *
 * The solver's own layout decides what is computed; this one only draws it.
 */

/** @typedef {import("./types.js").Study} Study */
/** @typedef {{ front: number, back: number, power: boolean }} Car extents relative to the first axle [m] */
/**
 * @typedef {object} Layout
 * @property {[number, number][]} spans beginning and end of each span [m]
 * @property {Car[]} cars
 * @property {number[]} axles x of each axle less the first [m]
 * @property {number[]} masses x of each sprung mass less the first [m]
 * @property {{ position: number, rail: string }[]} defects
 * @property {number | null} marked the middle of the judged span [m]
 */

/** A car's body reaches this far beyond its own outer bogie. [m] */
const OVERHANG = 3.6;
/** Half the gap between two cars. [m] */
const GAP = 0.2;

/**
 * @param {Study} study
 * @returns {Layout}
 */
export function layoutOf(study) {
  const spans = spansOf(study.viaduct ?? {});
  const train = study.train ?? {};
  const articulated = train.type === "articulated";
  const middle = spans.length === 1 ? spans[0] : spans[1];
  return {
    spans,
    ...(articulated ? carsOf(train) : { cars: [], axles: [] }),
    masses: articulated ? [] : massesOf(train),
    defects: defectsOf(study.irregularity),
    marked: middle ? (middle[0] + middle[1]) / 2 : null,
  };
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
    spans.push([start, start + Number(length)]);
  }
  return spans;
}

/** @param {any} train */
function massesOf(train) {
  const count = Math.min(Math.max(train.count ?? 1, 1), 40);
  return Array.from({ length: count }, (_, index) => -index * (train.spacing ?? 20) || 0);
}

/** @param {any} irregularity */
function defectsOf(irregularity) {
  if (!irregularity || !Number.isFinite(irregularity.position)) return [];
  return [{ position: irregularity.position, rail: irregularity.rail ?? "both" }];
}

/**
 * @param {any} train
 * @returns {{ cars: Car[], axles: number[] }}
 */
function carsOf(train) {
  const types = new Map((train.vehicle_types ?? []).map((/** @type {any} */ type) => [type.name, type]));
  const consist = (train.consist ?? []).map((/** @type {string} */ name) => types.get(name));
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
    const sharesBack = type.articulation === "both_ends" || (type.articulation === "trailing_end" && leading);
    cars.push({
      front: first + (shared ? -GAP : index ? half - GAP : OVERHANG),
      back: second - (sharesBack ? -GAP : index + 1 < consist.length ? half - GAP : OVERHANG),
      power: type.articulation === "none",
    });
    shared = sharesBack;
  });
  const wheel = (consist[0].wheelbase ?? 3) / 2;
  const axles = bogies.flatMap((bogie) => [bogie + wheel, bogie - wheel]);
  const move = -axles[0];
  return {
    cars: cars.map((car) => ({ ...car, front: car.front + move, back: car.back + move })),
    axles: axles.map((axle) => axle + move),
  };
}
