// @ts-check
/** The moment of a run that is shown first. Pure. */

/** @typedef {import("./types.js").Run} Run */

/**
 * When the verdict's value occurs; without a verdict, when the bridge is lowest.
 *
 * @param {Run} run
 * @returns {number | null} [s]
 */
export function momentOfInterest(run) {
  const verdict = run.verdicts?.[0];
  if (verdict) return verdict.time;
  const peaks = Object.entries(run.summary?.peaks ?? {});
  const lowest = peaks.find(([name]) => name.startsWith("mid-span") && name.endsWith("/displacement"));
  const time = /** @type {any} */ (lowest?.[1])?.time_of_least;
  return Number.isFinite(time) ? time : null;
}
