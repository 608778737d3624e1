// @ts-check
/**
 * Jobs as rows; each leads to its page. Emits `more` {cursor} where the server holds older ones, and
 * `tick` where rows can be ticked and another one was.
 */
import { jobRow } from "./job-row.js";
import { h, show } from "../dom.js";
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
  /** What is said where there is no job. @type {[string, string]} */
  empty = ["Nothing has run here yet.", "Press Run on a study: it computes in the background and stays in this list."];
  /** @type {import("./job-row.js").Ticks | null} */
  #ticks = null;

  connectedCallback() {
    this.addEventListener("keydown", (event) => this.#key(event));
  }

  /** Whether rows can be ticked. @param {boolean} tickable */
  set tickable(tickable) {
    if (!tickable) this.#ticks = null;
    else this.#ticks = { jobs: new Set(), runs: new Set(), opened: new Set(), change: (job, runs, on) => this.#tick(job, runs, on) };
  }

  /** Ids of the ticked jobs, and of their runs that are done, in the order of the list. */
  get ticked() {
    const inOrder = this.jobs.flatMap((job) => job.runs.map((run) => run.id));
    return {
      jobs: this.jobs.map((job) => job.id).filter((id) => this.#ticks?.jobs.has(id)),
      runs: inOrder.filter((id) => this.#ticks?.runs.has(id)),
    };
  }

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

  /** A job that is no more. @param {string} id */
  drop(id) {
    this.#jobs = this.jobs.filter((job) => job.id !== id);
    this.#ticks?.jobs.delete(id);
    this.#draw();
    this.dispatchEvent(new CustomEvent("tick"));
  }

  /**
   * @param {Job} job
   * @param {string[]} runs
   * @param {boolean} on
   */
  #tick(job, runs, on) {
    const ticks = this.#ticks;
    if (!ticks) return;
    for (const run of runs) ticks.runs[on ? "add" : "delete"](run);
    const whole = job.runs.length > 1 && runs.length === 1 ? job.runs.every((run) => ticks.runs.has(run.id)) : on;
    ticks.jobs[whole ? "add" : "delete"](job.id);
    this.#draw();
    this.dispatchEvent(new CustomEvent("tick"));
  }

  /** The arrows go from row to row. @param {KeyboardEvent} event */
  #key(event) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const row = /** @type {HTMLElement} */ (event.target).closest("li");
    if (!step || !row || event.ctrlKey || event.altKey || event.metaKey) return;
    const next = step > 0 ? row.nextElementSibling : row.previousElementSibling;
    const same = /** @type {HTMLElement} */ (event.target).matches("input") ? "input" : "a";
    event.preventDefault();
    /** @type {HTMLElement | null | undefined} */ (next?.querySelector(same))?.focus();
  }

  #draw() {
    const jobs = this.jobs.slice(0, this.limit);
    const focused = /** @type {HTMLElement | null} */ (this.contains(document.activeElement) ? document.activeElement : null);
    const kept = focused && (focused.dataset.tick ? `[data-tick="${focused.dataset.tick}"]` : `a[href="${focused.getAttribute("href")}"]`);
    show(
      this,
      jobs.length
        ? h("ul", { class: "jobs card" }, jobs.map((job) => jobRow(job, this.#ticks)))
        : h(
            "div",
            { class: "empty card" },
            h("p", null, this.empty[0]),
            h("p", { class: "soft" }, this.empty[1]),
          ),
      this.#further(),
    );
    if (kept) /** @type {HTMLElement | null} */ (this.querySelector(kept))?.focus();
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

customElements.define("tb-job-list", JobList);
