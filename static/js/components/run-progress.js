// @ts-check
/**
 * How far a job has come: bar, stage, what is left; in the queue its place, when it begins, and
 * whether it should begin sooner. Built once, then only its texts change. Emits `prioritise`
 * {priority}.
 */
import { h, show } from "../dom.js";
import { number, remaining } from "../format.js";

/** @typedef {import("../types.js").Job} Job */

export class RunProgress extends HTMLElement {
  #bar = h("progress", { max: 1, "aria-label": "Progress" });
  #stage = h("p", { class: "stage" });
  #left = h("p", { class: "soft" });
  #priority = 0;
  #place = h("div", { class: "row", hidden: true, role: "group", "aria-label": "Place in the queue" }, this.#button("Sooner", 1), this.#button("Later", -1));

  connectedCallback() {
    this.classList.add("card", "progress");
    show(this, h("div", { class: "row spread" }, this.#stage, this.#left, this.#place), this.#bar);
  }

  /**
   * @param {string} words
   * @param {number} change
   */
  #button(words, change) {
    const press = () => this.dispatchEvent(new CustomEvent("prioritise", { detail: { priority: this.#priority + change }, bubbles: true }));
    return h("button", { type: "button", onclick: press }, words);
  }

  /** @param {Job} job */
  set job(job) {
    const progress = job.progress ?? {};
    this.#priority = job.priority ?? 0;
    this.#place.hidden = job.state !== "queued";
    if (job.state === "queued") {
      this.#bar.removeAttribute("value");
      const ahead = job.position ?? 0;
      show(this.#stage, ahead > 0 ? `Waiting in the queue: ${ahead} job${ahead > 1 ? "s" : ""} before this one` : "Waiting for a free process");
      show(this.#left, `${urgency(job.priority)}${start(job.estimated_start)}It starts by itself; you may leave this page.`);
      return;
    }
    if (job.kind === "modes") {
      // One solution of one equation: it has stages, but no steps to count.
      this.#bar.removeAttribute("value");
      show(this.#stage, sentence(progress.stage || "starting"));
      show(this.#left);
      return;
    }
    const fraction = progress.fraction ?? 0;
    this.#bar.value = fraction;
    show(this.#stage, h("strong", null, `${Math.floor(fraction * 100)} %`), ` ${progress.stage || "starting"}`);
    show(this.#left, [runs(job), steps(progress), remaining(progress.remaining)].filter(Boolean).join(" · "));
  }
}

/** Of a sweep, how many runs have ended. @param {Job} job */
function runs({ runs }) {
  const ended = runs.filter((run) => run.state !== "queued" && run.state !== "running").length;
  return runs.length > 1 ? `${ended} of ${runs.length} speeds done` : "";
}

/**
 * When the job will begin, at the pace of the last ones.
 * @param {[string, string] | null | undefined} range
 */
function start(range) {
  if (!range) return "";
  const [earliest, latest] = range.map((time) => new Date(time).toLocaleTimeString([], { timeStyle: "short" }));
  return earliest === latest ? `Starts at about ${earliest}. ` : `Starts between ${earliest} and ${latest}. `;
}

/** @param {number} [priority] */
const urgency = (priority) => (priority ? `Priority ${number(priority, 3)}. ` : "");

/** @param {string} text */
const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** @param {import("../types.js").Progress} progress */
function steps(progress) {
  if (!progress.steps || !progress.step) return "";
  const rate = progress.rate ? `, ${number(progress.rate, 3)} a second` : "";
  return `step ${number(progress.step, 6)} of ${number(progress.steps, 6)}${rate}`;
}

customElements.define("tb-run-progress", RunProgress);
