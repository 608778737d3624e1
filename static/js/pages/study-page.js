// @ts-check
/** Set up a study: form on the left, drawing, estimate and Run beside it; checked as one types. */
import { Elevation } from "../components/elevation.js";
import { StudyForm } from "../components/study-form.js";
import { StudyReport } from "../components/study-report.js";
import { api, ApiError } from "../api.js";
import { h, show } from "../dom.js";
import { link } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Study} Study */
/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../types.js").Report} Report */

/** Typing pauses this long before the server is asked. [ms] */
const PAUSE = 300;

export class StudyPage extends HTMLElement {
  /** Name of the template to start from. */
  template = "";
  #kind = "crossing";
  /** @type {Study} */
  #study = {};
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {AbortController | null} */
  #asking = null;
  #form = /** @type {StudyForm} */ (h("tb-study-form"));
  #drawing = /** @type {Elevation} */ (h("tb-elevation"));
  #report = /** @type {StudyReport} */ (h("tb-study-report"));
  #run = h("button", { type: "button", class: "primary wide", onclick: () => void this.#submit(this.#kind) }, "Run");
  #modes = h("button", { type: "button", class: "wide", onclick: () => void this.#submit("modes") }, "Natural modes");
  #state = h("p", { class: "soft small", role: "status" });

  async connectedCallback() {
    show(this, h("div", { class: "skeleton" }));
    try {
      const meta = await store.get("meta");
      const [templates, document] = await Promise.all([
        api.templates(),
        api.schema(meta.openapi_url ?? "/api/v1/openapi.json"),
      ]);
      const template = templates.items.find(
        (/** @type {import("../types.js").Template} */ item) => item.name === this.template,
      );
      if (!template) throw new Error(`There is no study named ${this.template} to start from.`);
      this.#begin(template, document);
    } catch (error) {
      show(this, h("div", { class: "notice bad", role: "alert" }, h("p", null, /** @type {Error} */ (error).message)));
    }
  }

  disconnectedCallback() {
    clearTimeout(this.#timer);
    this.#asking?.abort();
  }

  /**
   * @param {import("../types.js").Template} template
   * @param {any} schema
   */
  #begin(template, schema) {
    this.#kind = template.kind ?? "crossing";
    this.#study = template.study;
    const title = template.title ?? template.study.name;
    document.title = `${title} · Trainbridge`;
    show(
      this,
      h("p", { class: "crumb" }, h("a", { href: "#/" }, "Home"), " / Customise"),
      h("h1", null, title),
      template.description && h("p", { class: "soft lead" }, template.description),
      h(
        "div",
        { class: "study" },
        this.#form,
        h("aside", { class: "card stack", "aria-label": "Check and run" }, h("div", { class: "drawing" }, this.#drawing), this.#report, this.#actions(), this.#state),
      ),
    );
    this.#form.bind(this.#study, schema);
    this.#drawing.study = this.#study;
    this.addEventListener("study", (event) => this.#changed(/** @type {CustomEvent} */ (event).detail));
    this.addEventListener("broken", () => this.#setReady(false, this.#toMend()));
    void this.#check();
  }

  #actions() {
    return h(
      "div",
      { class: "actions" },
      this.#run,
      this.#modes,
      h("p", { class: "soft small" }, "Natural modes: frequencies, damping and shapes of the viaduct with its track, without the train."),
    );
  }

  /** Which inputs to mend; each leads there. */
  #toMend() {
    const marked = this.#form.marked;
    if (!marked.length) return "Mend what is said above first.";
    const links = marked.map((field) =>
      h("button", { type: "button", class: "link", onclick: () => field.focus() }, field.name),
    );
    return ["To mend first: ", links.flatMap((item, index) => (index ? [", ", item] : [item]))];
  }

  /** @param {Study} study */
  #changed(study) {
    this.#study = study;
    this.#drawing.study = study;
    this.#setReady(false, "Checking…");
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#check(), PAUSE);
  }

  async #check() {
    this.#asking?.abort();
    const asking = new AbortController();
    this.#asking = asking;
    try {
      const report = await api.validate({ kind: this.#kind, study: this.#study }, asking.signal);
      this.#show(report, report.errors);
    } catch (error) {
      if (asking.signal.aborted) return;
      this.#refused(error);
    }
  }

  /**
   * @param {Report | null} report
   * @param {Finding[]} errors
   */
  #show(report, errors) {
    const elsewhere = this.#form.place(errors);
    this.#report.update(report, elsewhere);
    const fine = errors.length === 0 && !this.#form.broken;
    this.#setReady(fine, fine ? "Checked: ready to run." : this.#toMend());
  }

  /** @param {unknown} error */
  #refused(error) {
    const problem = /** @type {ApiError} */ (error);
    const findings = problem.findings?.length ? problem.findings : [{ pointer: "", reason: problem.message }];
    this.#show(null, findings);
  }

  /**
   * @param {boolean} ready
   * @param {import("../dom.js").Child} words
   */
  #setReady(ready, words) {
    this.#run.disabled = !ready;
    this.#modes.disabled = !ready;
    show(this.#state, words);
  }

  /** @param {string} kind */
  async #submit(kind) {
    this.#setReady(false, "Starting…");
    try {
      const job = await api.submit({ kind, study: this.#study });
      location.hash = link("jobs", job.id);
    } catch (error) {
      this.#refused(error);
    }
  }
}

customElements.define("tb-study-page", StudyPage);
