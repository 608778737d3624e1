// @ts-check
/** The moments of a run that are worth a look. Pure. */

/** @typedef {import("./types.js").Run} Run */
/** @typedef {{ time: number, words: string }} Moment time [s] */

/** Contact is lost below this compression. [N] */
const LOST = 0;
/** Below this one it pulls, as a contact may that was chosen so; above, it is rounding. [N] */
const PULLING = -1;

/**
 * The moments worth a look, the one that matters most first: when the verdict's value occurs, when
 * its raw value does, when each mid-span is lowest, when a wheel first presses least.
 *
 * @param {Run} run
 * @returns {Moment[]}
 */
export function momentsOfInterest(run) {
  const verdict = run.verdicts?.[0];
  const judged = verdict
    ? [
        { time: verdict.time, words: "greatest judged acceleration" },
        { time: verdict.raw?.time ?? Number.NaN, words: "greatest raw acceleration" },
      ]
    : [];
  const peaks = Object.entries(run.summary?.peaks ?? {});
  return [...judged, ...lowest(peaks), ...lightest(peaks)].filter((moment) => Number.isFinite(moment.time));
}

/**
 * When the one that matters most is, null where there is none.
 *
 * @param {Run} run
 * @returns {number | null} [s]
 */
export function momentOfInterest(run) {
  return momentsOfInterest(run)[0]?.time ?? null;
}

/**
 * @param {[string, any][]} peaks
 * @returns {Moment[]}
 */
function lowest(peaks) {
  return peaks
    .filter(([name]) => name.startsWith("mid-span") && name.endsWith("/displacement") && !name.includes("rail"))
    .map(([name, peak]) => ({ time: peak.time_of_least, words: `${name.split(/[,/]/)[0]} lowest` }));
}

/**
 * The wheel that presses least of all.
 *
 * @param {[string, any][]} peaks
 * @returns {Moment[]}
 */
function lightest(peaks) {
  const wheels = peaks.filter(([name, peak]) => name.endsWith("/contact force") && Number.isFinite(peak?.least));
  if (!wheels.length) return [];
  const [name, peak] = wheels.reduce((a, b) => (b[1].least < a[1].least ? b : a));
  const wheel = name.split("/")[0];
  const words = peak.least < PULLING ? "pulls most" : peak.least <= LOST ? "loses contact" : "presses least";
  return [{ time: peak.time_of_least, words: `${wheel} ${words}` }];
}
