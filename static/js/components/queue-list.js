// @ts-check
/** What computes now and what waits, in the order in which it begins. */
import { h, show } from "../dom.js";
import { number, remaining } from "../format.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */

/** Rows that are drawn; the others are counted. */
const ROWS = 6;

export class QueueList extends HTMLElement {
  /** @type {Map<string, Job>} */
  #jobs = new Map();

  /** Jobs that run or wait. @param {Job[]} jobs */
  set jobs(jobs) {
    this.#jobs = new Map(jobs.map((job) => [job.id, job]));
    this.#draw();
  }

  /** @param {Job} job that changed */
  update(job) {
    if (job.state === "running" || job.state === "queued") this.#jobs.set(job.id, job);
    else if (!this.#jobs.delete(job.id)) return;
    this.#draw();
  }

  #draw() {
    const all = [...this.#jobs.values()].sort((a, b) => order(a) - order(b));
    this.classList.add("card", "panel");
    const focused = this.contains(document.activeElement) && document.activeElement?.getAttribute("href");
    show(
      this,
      h("h2", null, "Queue"),
      all.length
        ? h("ol", { class: "queue" }, all.slice(0, ROWS).map(row))
        : h("p", { class: "soft" }, "Empty: the next job begins at once."),
      all.length > ROWS && h("p", { class: "soft small" }, `and ${all.length - ROWS} more`),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.querySelector(`a[href="${focused}"]`))?.focus();
  }
}

/** @param {Job} job */
const order = (job) => (job.state === "running" ? -1 : (job.position ?? Number.MAX_SAFE_INTEGER));

/** @param {Job} job */
function row(job) {
  const fraction = job.progress?.fraction ?? 0;
  const running = job.state === "running";
  return h(
    "li",
    null,
    h("a", { href: link("jobs", job.id) }, job.name || job.kind),
    h("span", { class: "soft small" }, running ? `${number(Math.floor(fraction * 100))} %, ${remaining(job.progress?.remaining) || "running"}` : waiting(job)),
    running && h("progress", { max: 1, value: fraction, "aria-label": `Progress of ${job.name}` }),
  );
}

/** @param {Job} job */
function waiting({ position }) {
  if (position === null || position === undefined) return "waits";
  return position === 0 ? "begins next" : `waits, ${number(position)} before it`;
}

customElements.define("tb-queue", QueueList);
