// @ts-check
/** The profile r(x) of an irregularity, for drawing. Pure. */

/** @typedef {{ name: string, r: number[] }} Line of one rail, or of all that are alike; r in m */
/** @typedef {{ x: number[], r: number[], lines: Line[], width: number, words: string }} Profile x and r in m; r is the first line's */

const POINTS = 241;
/** Half the drawn length, in widths 1/k: beyond four the bell is 3e-4 of its height. */
const REACH = 5;
/** Where a bell has one percent of its height: sqrt(2 ln 100), in widths 1/k. */
const ONE_PERCENT = Math.sqrt(2 * Math.log(100));
/** Points of the way back to zero beyond an end of the samples, closer near it. */
const FADE_POINTS = 32;
/** As the solver rounds a slope off at an end: no sharper than the samples bend, no higher than they are. */
const [ROUNDING, BULGE, LONGEST] = [3, 4, 0.9];
/** The rails of samples, in the order of the solver. @type {["left", "right"]} */
const RAILS = ["left", "right"];

/**
 * @param {any} irregularity
 * @returns {Profile | null} null where the rails are perfect or of a kind that is not drawn
 */
export function profileOf(irregularity) {
  if (irregularity?.type === "measured") return measured(irregularity);
  if (irregularity?.type !== "isolated") return null;
  const { amplitude, wave_number: k, position } = irregularity;
  if (![amplitude, k, position].every(Number.isFinite) || k <= 0) return null;
  const x = Array.from({ length: POINTS }, (_, index) => position + (REACH / k) * ((2 * index) / (POINTS - 1) - 1));
  const r = x.map((place) => amplitude * Math.exp(-0.5 * (k * (place - position)) ** 2));
  const width = (2 * ONE_PERCENT) / k;
  return { x, r, lines: [{ name: "", r }], width, words: words(irregularity, width) };
}

/**
 * Samples of both rails; where they are alike, one line stands for both.
 *
 * @param {any} irregularity
 * @returns {Profile | null} null without two samples of plain numbers
 */
function measured({ samples, fade }) {
  if (!Array.isArray(samples) || samples.length < 2 || !(fade > 0)) return null;
  if (!samples.every((sample) => [sample?.position, sample?.left, sample?.right].every(Number.isFinite))) return null;
  const places = samples.map((sample) => sample.position);
  const [first, last] = [places[0], places[places.length - 1]];
  const ways = Array.from({ length: FADE_POINTS }, (_, index) => fade * ((index + 1) / FADE_POINTS) ** 2);
  const x = [...ways.toReversed().map((way) => first - way), ...places, ...ways.map((way) => last + way)];
  const [left, right] = RAILS.map((rail) => {
    const values = samples.map((sample) => sample[rail]);
    const [begin, end] = [beyond(places, values, fade), beyond(places.toReversed(), values.toReversed(), fade)];
    return [...ways.toReversed().map(begin), ...values, ...ways.map(end)];
  });
  const alike = left.every((value, index) => value === right[index]);
  const lines = alike ? [{ name: "both rails", r: left }] : [{ name: "left rail", r: left }, { name: "right rail", r: right }]; // prettier-ignore
  return { x, r: left, lines, width: last - first, words: measuredWords(places, lines) };
}

/** The solver's way from 1 at t = 0 to 0 at t = 1, level and straight at both. @param {number} t */
const fall = (t) => 1 - t ** 3 * (10 - 15 * t + 6 * t * t);

/**
 * The way back to zero beyond the first of some samples, by the distance from it; slope and bend are
 * those of the parabolas through three samples.
 *
 * @param {number[]} places
 * @param {number[]} values
 * @param {number} fade
 * @returns {(way: number) => number}
 */
function beyond(places, values, fade) {
  const steps = places.slice(1).map((place, index) => Math.abs(place - places[index]) || 1);
  const slopes = steps.map((step, index) => (values[index + 1] - values[index]) / step);
  const bends = slopes.slice(1).map((slope, index) => (2 * (slope - slopes[index])) / (steps[index] + steps[index + 1]));
  const [bend = 0] = bends;
  const slope = 0.5 * bend * steps[0] - slopes[0];
  const sharpest = bends.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  const most = values.reduce((height, value) => Math.max(height, value), values[0]);
  const height = (most - values.reduce((least, value) => Math.min(least, value), most)) / 2;
  const natural = Math.min((ROUNDING * Math.abs(slope)) / sharpest, (BULGE * height) / Math.abs(slope));
  const length = Math.min(LONGEST * fade, Math.max(steps[0], natural || 0));
  const short = Math.min(steps[0], length / 2);
  const within = (/** @type {number} */ way, /** @type {number} */ end) => (way < end ? fall(way / end) : 0);
  return (way) => values[0] * fall(way / fade) + slope * way * within(way, length) + 0.5 * bend * way ** 2 * within(way, short);
}

/**
 * @param {number[]} places
 * @param {Line[]} lines
 */
function measuredWords(places, lines) {
  const heights = lines.map(({ name, r }) => `${millimetres(r.slice(FADE_POINTS, -FADE_POINTS).reduce((most, value) => Math.max(most, Math.abs(value)), 0))} mm on ${name === "both rails" ? name : `the ${name}`}`);
  return `${places.length} samples from x = ${+places[0].toFixed(2)} to ${+places[places.length - 1].toFixed(2)} m, at most ${heights.join(" and ")}.`;
}

/** @param {number} length [m] */
const millimetres = (length) => +(length * 1000).toPrecision(3);

/**
 * Where a measured profile lies and how it looks over the rails of a small drawing.
 *
 * @param {any} irregularity
 * @returns {{ from: number, to: number, words: string, paths: [number, number][][] } | null} heights of the paths
 *   from -1 to 1; null where nothing was measured
 */
export function stretchOf(irregularity) {
  const profile = irregularity?.type === "measured" ? profileOf(irregularity) : null;
  if (!profile) return null;
  const { x, lines, words: text } = profile;
  const most = lines.flatMap(({ r }) => r).reduce((height, value) => Math.max(height, Math.abs(value)), 0) || 1;
  return {
    from: x[FADE_POINTS],
    to: x[x.length - 1 - FADE_POINTS],
    words: text,
    paths: lines.map(({ r }) => x.map((place, index) => [place, r[index] / most])),
  };
}

/**
 * @param {any} irregularity
 * @param {number} width
 */
function words({ amplitude, position, rail }, width) {
  const height = `${+(Math.abs(amplitude) * 1000).toFixed(2)} mm ${amplitude < 0 ? "deep" : "high"}`;
  const where = rail === "both" ? "both rails" : `the ${rail} rail`;
  return `${height}, ${width.toFixed(1)} m from end to end (one percent of its height), at x = ${+position.toFixed(2)} m on ${where}.`;
}
