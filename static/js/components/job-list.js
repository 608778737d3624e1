// @ts-check
/** Jobs as rows; each leads to its page. */
import { h, show } from "../dom.js";
import { ago, number, remaining, stateText } from "../format.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */

export class JobList extends HTMLElement {
  /** @type {Job[] | null} */
  #jobs = null;

  /** Newest first. @returns {Job[]} */
  get jobs() {
    return this.#jobs ?? [];
  }

  set jobs(jobs) {
    this.#jobs = jobs;
    this.#draw();
  }

  /**
   * Puts a job that changed in its place, or on top where it is new.
   *
   * @param {Job} job
   */
  update(job) {
    if (!this.#jobs) return;
    const index = this.#jobs.findIndex((item) => item.id === job.id);
    if (index < 0) this.#jobs = [job, ...this.#jobs];
    else this.#jobs = this.#jobs.with(index, { ...this.#jobs[index], ...job });
    this.#draw();
  }

  #draw() {
    const jobs = this.#jobs ?? [];
    const focused = this.contains(document.activeElement)
      ? document.activeElement?.getAttribute("href")
      : null;
    show(
      this,
      jobs.length
        ? h("ul", { class: "jobs card" }, jobs.map((job) => h("li", null, row(job))))
        : h(
            "div",
            { class: "empty card" },
            h("p", null, "Nothing has run here yet."),
            h("p", { class: "soft" }, "Press Run on a study above: it computes in the background and stays in this list."),
          ),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.querySelector(`a[href="${focused}"]`))?.focus();
  }
}

/** @param {Job} job */
function row(job) {
  const fraction = job.progress?.fraction ?? 0;
  const active = job.state === "running";
  return h(
    "a",
    { href: link("jobs", job.id) },
    h("span", { class: "job-name" }, job.name || job.kind),
    h("span", { class: `tag ${job.state}` }, active ? `${number(Math.floor(fraction * 100))} %` : stateText(job.state)),
    h(
      "span",
      { class: "soft small job-when" },
      active ? remaining(job.progress?.remaining) : ago(job.ended ?? job.started ?? job.created, Date.now()),
    ),
    active && h("progress", { max: 1, value: fraction, "aria-label": `Progress of ${job.name}` }),
  );
}

customElements.define("tb-job-list", JobList);
