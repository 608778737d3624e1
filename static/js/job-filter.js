// @ts-check
/** Which jobs a list shows. Pure. */

/** @typedef {import("./types.js").Job} Job */
/** @typedef {{ name: string, title: string, states: string[] }} StateChoice */

/** What can be asked for, "all" first. @type {StateChoice[]} */
export const STATE_CHOICES = [
  { name: "", title: "All", states: [] },
  { name: "active", title: "Waiting or running", states: ["queued", "running"] },
  { name: "done", title: "Done", states: ["done"] },
  { name: "failed", title: "Failed", states: ["failed", "timed_out", "out_of_memory"] },
  { name: "cancelled", title: "Cancelled", states: ["cancelled"] },
];

/** @param {string} name */
export const statesOf = (name) => STATE_CHOICES.find((choice) => choice.name === name)?.states ?? [];

/**
 * Whether a job that has changed belongs into the list.
 *
 * @param {Pick<Job, "state" | "name">} job
 * @param {{ state: string, name: string }} filter
 */
export function matches(job, { state, name }) {
  const states = statesOf(state);
  return (states.length === 0 || states.includes(job.state)) && job.name.toLowerCase().includes(name.toLowerCase());
}

/**
 * Runs of a job that can be compared: those that are done.
 *
 * @param {Pick<Job, "runs" | "kind">} job
 */
export const comparable = (job) => (job.kind === "modes" ? [] : job.runs.filter((run) => run.state === "done").map((run) => run.id));
