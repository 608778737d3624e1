// @ts-check
/** The profile r(x) of an irregularity, for drawing. Pure. */

/** @typedef {{ x: number[], r: number[], width: number, words: string }} Profile x and r in m */

const POINTS = 241;
/** Half the drawn length, in widths 1/k: beyond four the bell is 3e-4 of its height. */
const REACH = 5;
/** Where a bell has one percent of its height: sqrt(2 ln 100), in widths 1/k. */
const ONE_PERCENT = Math.sqrt(2 * Math.log(100));

/**
 * @param {any} irregularity
 * @returns {Profile | null} null where the rails are perfect or of a kind that is not drawn
 */
export function profileOf(irregularity) {
  if (irregularity?.type !== "isolated") return null;
  const { amplitude, wave_number: k, position } = irregularity;
  if (![amplitude, k, position].every(Number.isFinite) || k <= 0) return null;
  const x = Array.from({ length: POINTS }, (_, index) => position + (REACH / k) * ((2 * index) / (POINTS - 1) - 1));
  const r = x.map((place) => amplitude * Math.exp(-0.5 * (k * (place - position)) ** 2));
  const width = (2 * ONE_PERCENT) / k;
  return { x, r, width, words: words(irregularity, width) };
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
