// @ts-check
/** A job that is not done: what happened, in plain words, and what to do. Pure. */
import { number } from "./format.js";
import { namedField } from "./job-words.js";

/** @typedef {import("./types.js").Job} Job */
/**
 * @typedef {{ heading: string, text: string, remedy: string, field: string, stable: string }} Words
 *   `field` is the pointer of the input that is at fault, `stable` how far it came
 */

/** @type {Record<string, { heading: string, remedy: string }>} */
const ENDED = {
  failed: {
    heading: "The computation stopped.",
    remedy: "Change the study and run it again.",
  },
  timed_out: {
    heading: "The computation took longer than is allowed here.",
    remedy: "Choose a coarser mesh, fewer speeds or a shorter run.",
  },
  out_of_memory: {
    heading: "The computation needed more memory than there is.",
    remedy: "Choose the coarse mesh, or run on a larger machine.",
  },
  cancelled: {
    heading: "This job was cancelled.",
    remedy: "It holds no verdict.",
  },
};

/** Where a modal analysis needs other advice. @type {Record<string, string>} */
const MODES = {
  timed_out: "Choose a coarser mesh.",
  cancelled: "It found no modes.",
};

/**
 * What to say of a job, null where nothing is amiss.
 *
 * @param {Pick<Job, "state" | "error"> & { kind?: string, progress?: Job["progress"] }} job
 * @returns {Words | null}
 */
export function troubleWords(job) {
  const ended = ENDED[job.state];
  if (!ended) return null;
  const error = job.error;
  const text = typeof error === "string" ? error : (error?.detail ?? error?.title ?? "");
  const own = typeof error === "object" ? error?.remedy : "";
  const remedy = own || (job.kind === "modes" ? MODES[job.state] : "") || ended.remedy;
  return { heading: ended.heading, text, remedy, field: namedField(text), stable: stableWords(job.progress) };
}

/**
 * How far a computation came before it ended.
 *
 * @param {Job["progress"]} progress
 */
function stableWords(progress) {
  if (!progress?.step || !progress.steps) return "";
  const time = progress.simulated_time ? `up to t = ${progress.simulated_time.toFixed(3)} s, ` : "";
  return `Computed ${time}step ${number(progress.step, 6)} of ${number(progress.steps, 6)}. What there is by then is shown below, marked as partial.`;
}
