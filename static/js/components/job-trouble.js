// @ts-check
/**
 * The face of a job that ended without a result: cause, the input at fault, how far it came, the
 * last lines of its log, what to do.
 */
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { label } from "../format.js";
import { logLines } from "../job-words.js";
import { link } from "../router.js";
import { troubleWords } from "../trouble.js";

/** @typedef {import("../types.js").Job} Job */

/** Lines of the log that tell of the end. */
const TAIL = 8;

export class JobTrouble extends HTMLElement {
  #log = h("ol", { class: "log mono" });

  /** @param {Job} job */
  set job(job) {
    const words = troubleWords(job);
    this.hidden = words === null;
    if (!words) return;
    const cancelled = job.state === "cancelled";
    const edit = (/** @type {Record<string, string>} */ more) => `#/study?${new URLSearchParams({ job: job.id, ...more })}`;
    const runs = job.runs.filter((run) => run.state !== "done" && run.error).length;
    show(
      this,
      h(
        "div",
        { class: `notice ${cancelled ? "" : "bad"}`, role: "alert" },
        h(
          "div",
          null,
          h("p", null, h("strong", null, words.heading), job.runs.length > 1 && runs > 0 && ` ${runs} of ${job.runs.length} runs.`),
          words.text && h("p", null, words.text),
          words.stable && h("p", null, words.stable),
          h("p", { class: "soft" }, words.remedy),
          h(
            "p",
            { class: "row" },
            words.field
              ? h("a", { href: edit({ field: words.field }) }, `Change ${label(words.field.split("/").slice(1).join(", ")).toLowerCase()} in a copy`)
              : h("a", { href: edit({}) }, "Edit a copy"),
            cancelled && h("a", { href: link("home") }, "Choose a study"),
          ),
          !cancelled && h("details", { open: true }, h("summary", null, "Last lines of the log"), this.#log),
        ),
      ),
    );
    if (!cancelled) void this.#tail(job.id);
  }

  /** @param {string} job */
  async #tail(job) {
    try {
      const lines = logLines(await api.jobLog(job)).slice(-TAIL);
      show(this.#log, lines.map(({ run, words }) => h("li", null, h("span", { class: "log-run" }, run), h("span", null, words))));
    } catch (error) {
      show(this.#log, h("li", null, /** @type {Error} */ (error).message));
    }
  }
}

customElements.define("tb-job-trouble", JobTrouble);
