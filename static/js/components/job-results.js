// @ts-check
/** What runs came to: the verdicts of one, or why there is none; the deciding verdict of each. */
import { VerdictBar } from "./verdict-bar.js";
import { api } from "../api.js";
import { h } from "../dom.js";

/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../job-words.js").Judged} Judged */

/** The deciding verdicts of a sweep's runs; each is asked for once. */
export class Verdicts {
  /** By run and attempt. @type {Map<string, Judged | null>} */
  #known = new Map();

  /**
   * Of those that have one.
   *
   * @param {import("../types.js").RunItem[]} runs that are done
   * @returns {Promise<Judged[]>}
   */
  async of(runs) {
    const key = (/** @type {import("../types.js").RunItem} */ run) => `${run.id} ${run.attempt ?? 0}`;
    const fresh = runs.filter((run) => !this.#known.has(key(run)));
    await Promise.all(
      fresh.map(async (run) => {
        const { items } = await api.runVerdicts(run.id);
        this.#known.set(key(run), items.length ? { run: run.id, verdict: items[0] } : null);
      }),
    );
    return runs.flatMap((run) => this.#known.get(key(run)) ?? []);
  }
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
