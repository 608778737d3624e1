// @ts-check
/** Home: studies that are ready to run, and what has run. */
import "../components/elevation.js";
import { JobList } from "../components/job-list.js";
import { TemplateCard } from "../components/template-card.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { link } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Template} Template */

/** Jobs that the list on this page shows. */
const RECENT = 8;

export class HomePage extends HTMLElement {
  #ended = new AbortController();
  #notice = h("div", { role: "alert" });
  #cards = h("div", { class: "templates" }, h("div", { class: "skeleton" }), h("div", { class: "skeleton" }));
  #jobs = /** @type {JobList} */ (h("tb-job-list"));
  #queue = h("span", { class: "soft small" });

  connectedCallback() {
    document.title = "Trainbridge";
    this.#jobs.limit = RECENT;
    show(
      this,
      h(
        "div",
        { class: "hero" },
        h("h1", null, "Run a train over a bridge and read the verdict."),
        h("p", { class: "soft" }, "Wheels, track and viaduct are solved together, step by step, and judged against the Eurocode."),
      ),
      this.#notice,
      this.#cards,
      h("div", { class: "row spread section-head" }, h("h2", null, "Recent jobs"), this.#queue),
      this.#jobs,
    );
    this.addEventListener("run", (event) => {
      void this.#run(/** @type {TemplateCard} */ (event.target), /** @type {CustomEvent} */ (event).detail);
    });
    void this.#load();
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  async #load() {
    try {
      const [templates, jobs] = await Promise.all([api.templates(), api.jobs()]);
      const items = /** @type {Template[]} */ (templates.items);
      const cards = items.map(card);
      show(this.#cards, cards);
      this.#jobs.page = jobs;
      this.#count();
      store.watch("job", (job) => this.#update(job), this.#ended.signal);
      for (const [index, item] of items.entries()) void estimate(item, cards[index]);
    } catch (error) {
      show(this.#cards);
      this.#complain(error);
    }
  }

  /** @param {import("../types.js").Job} job */
  #update(job) {
    this.#jobs.update(job);
    this.#count();
  }

  #count() {
    const jobs = this.#jobs.jobs;
    const waiting = jobs.filter((job) => job.state === "queued").length;
    const running = jobs.filter((job) => job.state === "running").length;
    show(this.#queue, running || waiting ? `${running} running, ${waiting} waiting` : "The queue is empty.");
  }

  /**
   * @param {TemplateCard} card
   * @param {Template} template
   */
  async #run(card, template) {
    card.busy = true;
    try {
      const job = await api.submit({ kind: template.kind ?? "crossing", study: template.study });
      location.hash = link("jobs", job.id);
    } catch (error) {
      card.busy = false;
      this.#complain(error);
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

/**
 * The size of a template as the server estimates it on this machine.
 *
 * @param {Template} template
 * @param {TemplateCard} card
 */
async function estimate(template, card) {
  try {
    card.report = await api.validate({ kind: template.kind ?? "crossing", study: template.study });
  } catch {
    // The card stays without its numbers; Run says what is wrong.
  }
}

customElements.define("tb-home-page", HomePage);
