// @ts-check
/** What runs came to: the verdicts of one, or why there is none; the deciding verdict of each. */
import { VerdictBar } from "./verdict-bar.js";
import { api } from "../api.js";
import { h } from "../dom.js";

/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../job-words.js").Judged} Judged */

/**
 * The deciding verdict of each run that has one.
 *
 * @param {string[]} runs
 * @returns {Promise<Judged[]>}
 */
export async function verdictsOf(runs) {
  const answers = await Promise.all(runs.map((run) => api.runVerdicts(run)));
  return answers.flatMap((answer, index) => (answer.items.length ? [{ run: runs[index], verdict: answer.items[0] }] : []));
}

/** @param {Run} run */
export function verdictBars(run) {
  const summary = run.summary ?? {};
  const bars = (run.verdicts ?? []).map((verdict) => {
    const bar = /** @type {VerdictBar} */ (h("tb-verdict-bar"));
    bar.bind(verdict, summary.facts?.mesh_accuracy ?? []);
    return bar;
  });
  if (bars.length || !summary.unjudged) return bars;
  return h("div", { class: "notice" }, h("p", null, summary.unjudged));
}

/** @param {unknown} error */
export function complaint(error) {
  const text = error instanceof Error ? error.message : String(error);
  return h("div", { class: "notice bad", role: "alert" }, h("p", null, text));
}
