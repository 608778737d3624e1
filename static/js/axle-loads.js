// @ts-check
/** What each axle of a train weighs, from lever arms. Pure. */
import { axleRows, sharesBack } from "./layout.js";

/** @typedef {{ front: number, back: number }} Ends share of a carbody on its front and back bogie [1] */
/** @typedef {{ x: number, load: number | undefined, lower: boolean }} Label of one axle or of a pair: place [m], load of one [kg] */

/** Labels of axles nearer than this would write over each other. [m] */
const CLOSE = 4;
/** Loads that differ by less are the same. [kg] */
const SAME = 0.5;
/** Gravity of the solver, by which a load has its mass. [m/s2] */
export const GRAVITY = 9.81;

/**
 * Static load of each axle, from the first to the last.
 *
 * @param {any} train
 * @returns {number[]} [kg]
 */
export function axleLoads(train) {
  if (train?.type === "axle_table") return axleRows(train).map((axle) => (Number(axle.load) || 0) / GRAVITY);
  if (train?.type !== "articulated") return Array(Math.min(Math.max(train?.count ?? 1, 1), 100)).fill(train?.mass ?? 0);
  const types = new Map((train.vehicle_types ?? []).map((/** @type {any} */ type) => [type.name, type]));
  const cars = (train.consist ?? []).map((/** @type {string} */ name) => types.get(name));
  if (!cars.length || cars.some((/** @type {any} */ car) => !car)) return [];
  /** Loads of bogies; a shared one has the bogie of the car whose second bogie it is not. @type {number[]} */
  const bogies = [];
  let shared = false;
  cars.forEach((/** @type {any} */ car, /** @type {number} */ index) => {
    const leading = index < cars.length / 2;
    const ends = endsOf(car, leading, train.passenger_orientation);
    if (!shared) bogies.push(own(car));
    bogies[bogies.length - 1] += ends.front * car.carbody_mass;
    shared = sharesBack(car, leading);
    const next = cars[index + 1];
    const whose = shared && next?.articulation === "both_ends" ? next : car;
    bogies.push(own(whose) + ends.back * car.carbody_mass);
  });
  return bogies.flatMap((load) => [load / 2, load / 2]);
}

/** A bogie with its two wheelsets. @param {any} car [kg] */
const own = (car) => car.bogie_mass + 2 * car.wheelset_mass;

/**
 * Cars of the first half run with their leading end ahead, those of the second half behind; only
 * cars articulated at both ends can be turned round.
 *
 * @param {any} car
 * @param {boolean} leading whether it is in the first half
 * @param {string} orientation
 * @returns {Ends}
 */
function endsOf(car, leading, orientation) {
  const inwards = car.articulation === "both_ends" && orientation === "leading_inwards";
  const length = car.leading_distance + car.trailing_distance;
  const onLeading = car.trailing_distance / length;
  return leading !== inwards ? { front: onLeading, back: 1 - onLeading } : { front: 1 - onLeading, back: onLeading };
}

/**
 * Neighbouring axles with the same load, once.
 *
 * @param {number[]} loads [kg]
 * @returns {{ first: number, last: number, load: number }[]} numbers of axles from 1
 */
export function axleGroups(loads) {
  /** @type {{ first: number, last: number, load: number }[]} */
  const groups = [];
  loads.forEach((load, index) => {
    const group = groups[groups.length - 1];
    if (group && Math.abs(group.load - load) < SAME) group.last = index + 1;
    else groups.push({ first: index + 1, last: index + 1, load });
  });
  return groups;
}

/**
 * What is written under the axles: close neighbours that weigh the same share a label, others take
 * turns in two rows.
 *
 * @param {number[]} axles
 * @param {number[]} loads [kg]
 * @returns {Label[]}
 */
export function axleLabels(axles, loads) {
  /** @type {Label[]} */
  const found = [];
  for (let index = 0; index < axles.length; index += 1) {
    const near = axles[index] - axles[index + 1] < CLOSE;
    const shares = near && Math.abs(loads[index] - loads[index + 1]) < SAME;
    const x = shares ? (axles[index] + axles[index + 1]) / 2 : axles[index];
    const before = found[found.length - 1];
    found.push({ x, load: loads[index], lower: before !== undefined && before.x - x < CLOSE && !before.lower });
    if (shares) index += 1;
  }
  return found;
}
