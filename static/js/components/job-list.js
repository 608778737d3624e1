// @ts-check
/** Jobs as rows; each leads to its page. Emits `more` {cursor} where the server holds older ones. */
import { h, show } from "../dom.js";
import { ago, number, remaining, stateText } from "../format.js";
import { subject } from "../job-words.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").JobPage} JobPage */

export class JobList extends HTMLElement {
  /** @type {Job[] | null} */
  #jobs = null;
  /** @type {string | null} */
  #next = null;
  /** Rows that are drawn at most; older jobs are on a page of their own. */
  limit = Number.POSITIVE_INFINITY;

  /** Newest first. @returns {Job[]} */
  get jobs() {
    return this.#jobs ?? [];
  }

  /** The first page of jobs. @param {JobPage} page */
  set page({ items, next }) {
    this.#jobs = items;
    this.#next = next ?? null;
    this.#draw();
  }

  /** The page that follows; a job that moved there meanwhile is not shown twice. @param {JobPage} page */
  add({ items, next }) {
    const known = new Set(this.jobs.map((job) => job.id));
    this.#jobs = [...this.jobs, ...items.filter((job) => !known.has(job.id))];
    this.#next = next ?? null;
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
    if (index >= 0) this.#jobs = this.#jobs.with(index, { ...this.#jobs[index], ...job });
    else if (isNewer(job, this.#jobs[0])) this.#jobs = [job, ...this.#jobs];
    this.#draw();
  }

  #draw() {
    const jobs = this.jobs.slice(0, this.limit);
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
            h("p", { class: "soft" }, "Press Run on a study: it computes in the background and stays in this list."),
          ),
      this.#further(),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.querySelector(`a[href="${focused}"]`))?.focus();
  }

  #further() {
    const rest = this.#next !== null || this.jobs.length > this.limit;
    if (!rest) return null;
    if (Number.isFinite(this.limit)) return h("p", { class: "further" }, h("a", { class: "button", href: link("jobs") }, "All jobs"));
    const button = h("button", { type: "button", onclick: () => this.#ask(button) }, "Show more");
    return h("p", { class: "further" }, button);
  }

  /** @param {HTMLButtonElement} button */
  #ask(button) {
    button.disabled = true;
    this.dispatchEvent(new CustomEvent("more", { detail: { cursor: this.#next }, bubbles: true }));
  }
}

/**
 * An older job that changes is on a page that is not shown yet.
 *
 * @param {Job} job
 * @param {Job | undefined} first
 */
function isNewer(job, first) {
  return !first || Date.parse(job.created) >= Date.parse(first.created);
}

/** @param {Job} job */
function row(job) {
  const fraction = job.progress?.fraction ?? 0;
  const active = job.state === "running";
  const counted = active && job.kind !== "modes";
  return h(
    "a",
    { href: link("jobs", job.id) },
    h("span", { class: "job-name" }, job.name || job.kind),
    h("span", { class: "soft small job-what" }, subject(job)),
    h("span", { class: `tag ${job.state}` }, counted ? `${number(Math.floor(fraction * 100))} %` : stateText(job.state)),
    h(
      "span",
      { class: "soft small job-when" },
      active ? remaining(job.progress?.remaining) : ago(job.ended ?? job.started ?? job.created, Date.now()),
    ),
    counted && h("progress", { max: 1, value: fraction, "aria-label": `Progress of ${job.name}` }),
  );
}

customElements.define("tb-job-list", JobList);
