// @ts-check
/** Home: studies that are ready to run, what has run, what waits, and the machine. */
import { JobList } from "../components/job-list.js";
import { MachineLine } from "../components/machine-line.js";
import { QueueList } from "../components/queue-list.js";
import { TemplateCard } from "../components/template-card.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { link } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Template} Template */
/** @typedef {import("../types.js").Job} Job */

/** Jobs that the list on this page shows. */
const RECENT = 6;
/** How long after a job's change the machine is asked again. [ms] */
const PAUSE = 1000;

export class HomePage extends HTMLElement {
  #ended = new AbortController();
  #notice = h("div", { role: "alert" });
  #cards = h("div", { class: "templates" }, h("div", { class: "skeleton" }), h("div", { class: "skeleton" }), h("div", { class: "skeleton" }), h("div", { class: "skeleton" }));
  #jobs = /** @type {JobList} */ (h("tb-job-list"));
  #queue = /** @type {QueueList} */ (h("tb-queue"));
  #machine = /** @type {MachineLine} */ (h("tb-machine"));
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  connectedCallback() {
    document.title = "Trainbridge";
    this.#jobs.limit = RECENT;
    show(
      this,
      h("div", { class: "hero" }, h("h1", null, "Run a train over a bridge, and read whether the standard allows it.")),
      this.#notice,
      this.#cards,
      h("div", { class: "home-head" }, h("h2", null, "Recent jobs")),
      this.#jobs,
      h("div", { class: "panels" }, this.#queue, this.#machine),
    );
    this.addEventListener("run", (event) => {
      void this.#run(/** @type {TemplateCard} */ (event.target), /** @type {CustomEvent} */ (event).detail);
    });
    void this.#load();
  }

  disconnectedCallback() {
    this.#ended.abort();
    clearTimeout(this.#timer);
  }

  async #load() {
    /** Jobs that change while the lists are on their way. @type {Map<string, Job> | null} */
    let early = new Map();
    store.watch("job", (job) => (early ? early.set(job.id, job) : this.#update(job)), this.#ended.signal);
    try {
      const [templates, jobs, waiting] = await Promise.all([api.templates(), api.jobs(), api.findJobs({ states: ["running", "queued"], name: "" })]);
      show(this.#cards, templates.items.map(card));
      this.#jobs.page = jobs;
      this.#queue.jobs = waiting.items;
      early.forEach((job) => this.#update(job));
      early = null;
      void this.#ask();
    } catch (error) {
      show(this.#cards);
      this.#complain(error);
    }
  }

  /** @param {Job} job */
  #update(job) {
    this.#jobs.update(job);
    this.#queue.update(job);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#ask(), PAUSE);
  }

  async #ask() {
    try {
      this.#machine.machine = await api.machine();
    } catch {
      // The banner says that the server is away; the last figures stay.
    }
  }

  /**
   * @param {TemplateCard} card
   * @param {Template} template
   */
  async #run(card, template) {
    card.busy = true;
    try {
      const job = await api.submit({ kind: template.kind ?? "crossing", study: template.study });
      if (this.isConnected) location.hash = link("jobs", job.id); // whoever left meanwhile is not called back
    } catch (error) {
      card.busy = false;
      this.#complain(error);
      this.#notice.scrollIntoView({ block: "center" });
    }
  }

  /** @param {unknown} error */
  #complain(error) {
    show(this.#notice, h("div", { class: "notice bad" }, h("p", null, /** @type {Error} */ (error).message)));
  }
}

/** @param {Template} template */
function card(template) {
  const element = /** @type {TemplateCard} */ (h("tb-template-card"));
  element.template = template;
  return element;
}

customElements.define("tb-home-page", HomePage);
