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

/**
 * Whether a job that had ended computes again, as a retry makes it.
 *
 * @param {Pick<Job, "state" | "runs">} before
 * @param {Pick<Job, "state" | "runs">} job
 */
export function begunAgain(before, job) {
  const more = job.runs.some((run, index) => (run.attempt ?? 0) > (before.runs[index]?.attempt ?? 0) || run.state === "queued");
  return before.state !== "done" && more;
}

/**
 * The entries of a log: `time  run 0 (id)  words`, one a line.
 *
 * @param {string} text
 * @returns {{ time: string, run: string, words: string }[]}
 */
export function logLines(text) {
  return text
    .split("\n")
    .filter((line) => line.trim())
    .map((line) => {
      const [time, who = "", ...words] = line.split("  ");
      const run = /^run (\d+)/.exec(who);
      return { time, run: run ? `run ${Number(run[1]) + 1}` : who, words: words.join("  ") };
    });
}

/**
 * The pointer of the input that an error names: `integration.time_step = 0.1: too long.`
 *
 * @param {string} detail
 */
export function namedField(detail) {
  const name = /^([a-z_]\w*(?:[.[][\w\]]+)*) = /.exec(detail)?.[1];
  return name ? `/${name.replace(/\]/g, "").split(/[.[]/).join("/")}` : "";
}

/** Whether a job or a run still waits or computes. @param {Pick<Job, "state">} job */
export const isActive = ({ state }) => state === "queued" || state === "running";

/** How many runs of a job have ended. @param {Pick<Job, "runs"> | null} job */
export const endedRuns = (job) => job?.runs.filter((run) => !isActive(run)).length;

/** What the browser's tab says. @param {Pick<Job, "state" | "name" | "progress">} job */
export function tabTitle({ state, name, progress }) {
  const percent = Math.floor((progress?.fraction ?? 0) * 100);
  return `${state === "running" && percent ? `${percent} % · ` : ""}${name} · Trainbridge`;
}

/**
 * The run that is shown: the chosen one, else the proposed one, else the first that has begun.
 *
 * @param {Job["runs"]} runs
 * @param {string} chosen id, which may be of another job
 * @param {string} proposed id
 * @returns {string} id; empty where there is no run
 */
export function shownRun(runs, chosen, proposed) {
  const named = (/** @type {string} */ id) => runs.find((run) => run.id === id);
  return (named(chosen) ?? named(proposed) ?? runs.find(({ progress }) => progress?.step) ?? runs[0])?.id ?? "";
}
