// @ts-check
/** What somebody can do with a job. */
import { api } from "./api.js";
import { confirmed } from "./components/confirm.js";
import { link } from "./router.js";

/** @typedef {import("./types.js").Job} Job */
/** @typedef {import("./components/job-head.js").Action} Action */

const LOST = "Its results, histories and pictures go with it. The study can be kept: save it from Files first.";

/**
 * Does it, and leads to where it is seen.
 *
 * @param {Action} action
 * @param {string} id
 * @returns {Promise<Job | null>} the job as it is then, null where another page shows what came of it
 */
export async function actOn(action, id) {
  if (action === "cancel") return (await api.cancel(id)) ?? api.job(id);
  if (action === "retry") return api.retry(id);
  if (action === "clone") {
    location.hash = link("jobs", (await api.clone(id)).id);
    return null;
  }
  if (await confirmed({ question: "Delete this job?", words: LOST, action: "Delete" })) {
    await api.removeJob(id);
    location.hash = link("jobs");
  }
  return null;
}
