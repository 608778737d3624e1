// @ts-check
/** What a job computes, in a few words, and which of its runs matters most. Pure. */
import { number, speed } from "./format.js";

/** @typedef {import("./types.js").Job} Job */
/** @typedef {{ run: string, verdict: import("./types.js").Verdict }} Judged a run and what decides it */

/** @param {Pick<Job, "kind"> & { runs?: Job["runs"] }} job */
export function subject(job) {
  if (job.kind === "modes") return "Natural modes";
  const speeds = (job.runs ?? []).map((run) => run.parameters?.speed).filter(Number.isFinite);
  if (speeds.length < 2) return speeds.length ? speed(speeds[0]) : "Crossing";
  const kilometres = (/** @type {number} */ value) => number(Math.round(value * 36) / 10, 4);
  return `${speeds.length} speeds, ${kilometres(Math.min(...speeds))} to ${speed(Math.max(...speeds))}`;
}

/**
 * The run whose verdict is furthest beyond its limit, or nearest to it.
 *
 * @param {Judged[]} judged
 */
export function worst(judged) {
  const use = (/** @type {Judged} */ item) => item.verdict.value / item.verdict.limit;
  return judged.reduce((a, b) => (use(b) > use(a) ? b : a));
}
