// @ts-check
/** The face of a job that is not done: what happened, in plain words, and what to do. */
import { h } from "./dom.js";

/** @typedef {import("./types.js").Job} Job */
/** @typedef {{ heading: string, text: string, remedy: string }} Words */

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
 * What to say of a job, null where nothing is amiss. Pure.
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
  const kept = job.progress?.step ? " What had been computed by then is shown below." : "";
  const remedy = own || (job.kind === "modes" ? MODES[job.state] : "") || ended.remedy;
  return { heading: ended.heading, text, remedy: `${remedy}${kept}` };
}

/** @param {Job} job */
export function trouble(job) {
  const words = troubleWords(job);
  if (!words) return null;
  return h(
    "div",
    { class: `notice ${job.state === "cancelled" ? "" : "bad"}`, role: "alert" },
    h(
      "div",
      null,
      h("p", null, h("strong", null, words.heading)),
      words.text && h("p", null, words.text),
      h("p", { class: "soft" }, words.remedy, " ", h("a", { href: "#/" }, "Choose a study")),
    ),
  );
}
