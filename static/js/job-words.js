// @ts-check
/** What a job computes, in a few words. Pure. */
import { number, speed } from "./format.js";

/** @typedef {import("./types.js").Job} Job */

/** @param {Pick<Job, "kind"> & { runs?: Job["runs"] }} job */
export function subject(job) {
  if (job.kind === "modes") return "Natural modes";
  const speeds = (job.runs ?? []).map((run) => run.parameters?.speed).filter(Number.isFinite);
  if (speeds.length < 2) return speeds.length ? speed(speeds[0]) : "Crossing";
  const kilometres = (/** @type {number} */ value) => number(Math.round(value * 36) / 10, 4);
  return `${speeds.length} speeds, ${kilometres(Math.min(...speeds))} to ${speed(Math.max(...speeds))}`;
}
