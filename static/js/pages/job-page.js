// @ts-check
/** One job: its state, its verdict, and the instrument of 3D view, plots and one time cursor. */
import { RunInstrument } from "../components/run-instrument.js";
import { RunProgress } from "../components/run-progress.js";
import { VerdictBar } from "../components/verdict-bar.js";
import { RunFacts } from "../components/run-facts.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { ago, speed, stateText } from "../format.js";
import { momentOfInterest } from "../moment.js";
import { store } from "../store.js";
import { trouble } from "../trouble.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */

const ACTIVE = new Set(["queued", "running"]);

export class JobPage extends HTMLElement {
  /** Id of the job. */
  job = "";
  query = new URLSearchParams();
  #ended = new AbortController();
  /** @type {Job | null} */
  #known = null;
  /** Id of the run that is shown, where there are several. */
  #chosen = "";
  #head = h("div", { class: "job-head" });
  #state = h("div", { class: "stack", "aria-live": "polite" });
  #progress = /** @type {RunProgress} */ (h("tb-run-progress", { hidden: true }));
  #instrument = /** @type {RunInstrument} */ (h("tb-run-instrument", { hidden: true }));
  #facts = /** @type {RunFacts} */ (h("tb-run-facts", { hidden: true }));

  connectedCallback() {
    show(
      this,
      h("p", { class: "crumb" }, h("a", { href: "#/" }, "Home"), " / ", h("a", { href: "#/jobs" }, "Jobs"), " / This job"),
      this.#head,
      this.#state,
      this.#progress,
      this.#instrument,
      this.#facts,
    );
    store.watch(`job:${this.job}`, (job) => this.#update(job), this.#ended.signal);
    void this.#load();
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  async #load() {
    try {
      this.#update(await api.job(this.job));
    } catch (error) {
      const unknown = /** @type {any} */ (error).status === 404;
      const text = unknown ? "There is no such job here. It may have been removed." : /** @type {Error} */ (error).message;
      show(this.#state, h("div", { class: "notice bad", role: "alert" }, h("p", null, text)));
    }
  }

  /** @param {Job} job */
  #update(job) {
    const before = this.#known;
    // An answer that was overtaken by the event stream must not turn the time back.
    if (before && !ACTIVE.has(before.state) && ACTIVE.has(job.state)) return;
    this.#known = job;
    document.title = `${job.state === "running" ? `${Math.floor((job.progress?.fraction ?? 0) * 100)} % · ` : ""}${job.name} · Trainbridge`;
    const active = ACTIVE.has(job.state);
    this.#progress.hidden = !active;
    if (active) this.#progress.job = job;
    if (before?.state !== job.state) this.#enter(job);
    this.#follow(job);
  }

  /**
   * A new state: its face.
   *
   * @param {Job} job
   */
  #enter(job) {
    show(this.#head, this.#title(job));
    if (job.state === "done") void this.#finish(job);
    else show(this.#state, trouble(job));
  }

  /** @param {Job} job */
  #title(job) {
    const at = job.runs[0]?.parameters?.speed;
    const cancel = h("button", { type: "button", class: "danger", onclick: () => void this.#cancel(cancel) }, "Cancel");
    return h(
      "div",
      { class: "row spread" },
      h(
        "div",
        null,
        h("h1", null, job.name || job.kind),
        h("p", { class: "soft" }, [job.runs.length > 1 ? `${job.runs.length} runs` : at && speed(at), `submitted ${ago(job.created, Date.now())}`].filter(Boolean).join(" · ")),
      ),
      h("div", { class: "row" }, job.runs.length > 1 && this.#picker(job), h("span", { class: `tag ${job.state}` }, stateText(job.state)), ACTIVE.has(job.state) && cancel),
    );
  }

  /** Which run is shown. @param {Job} job */
  #picker(job) {
    const select = h(
      "select",
      { "aria-label": "Run", onchange: () => this.#choose(select.value, job) },
      job.runs.map((run) => h("option", { value: run.id, selected: run.id === this.#chosen }, speed(run.parameters.speed))),
    );
    return select;
  }

  /**
   * @param {string} run
   * @param {Job} job
   */
  #choose(run, job) {
    this.#chosen = run;
    const fresh = /** @type {RunInstrument} */ (h("tb-run-instrument", { hidden: true }));
    this.#instrument.replaceWith(fresh);
    this.#instrument = fresh;
    this.query = new URLSearchParams();
    const newest = this.#known ?? job;
    this.#follow(newest);
    if (newest.state === "done") void this.#finish(newest);
  }

  /** @param {HTMLButtonElement} button */
  async #cancel(button) {
    button.disabled = true;
    show(button, "Cancelling…");
    try {
      this.#update((await api.cancel(this.job)) ?? (await api.job(this.job)));
    } catch (error) {
      button.disabled = false;
      show(button, "Cancel");
      show(this.#state, h("div", { class: "notice bad", role: "alert" }, h("p", null, /** @type {Error} */ (error).message)));
    }
  }

  /**
   * Curves as soon as there are steps, and whatever there is of a run that ended early.
   *
   * @param {Job} job
   */
  #follow(job) {
    const run = job.runs.find((item) => item.id === this.#chosen) ?? job.runs[0];
    if (!run || job.kind === "modes") return;
    const stepped = (run.progress?.step ?? 0) > 0 || run.state === "done";
    if (!stepped) return;
    if (this.#instrument.hidden) {
      this.#instrument.hidden = false;
      this.#instrument.bind({ run: run.id, query: this.query });
    }
    this.#instrument.progress(run.state, run.progress?.simulated_time ?? null);
  }

  /** @param {Job} job */
  async #finish(job) {
    /** @type {Run[]} */
    const runs = await Promise.all(job.runs.map((run) => api.run(run.id)));
    const verdicts = runs.flatMap((run) => run.verdicts ?? []);
    const unjudged = runs.map((run) => /** @type {any} */ (run.summary)?.unjudged).find(Boolean);
    const bars = verdicts.map((verdict) => {
      const bar = /** @type {VerdictBar} */ (h("tb-verdict-bar"));
      bar.verdict = verdict;
      return bar;
    });
    show(this.#state, bars, bars.length === 0 && unjudged && h("div", { class: "notice" }, h("p", null, unjudged)));
    const shown = runs.find((run) => run.id === this.#chosen) ?? runs[0];
    const moment = momentOfInterest(shown);
    if (moment !== null) this.#instrument.suggest(moment);
    this.#facts.hidden = false;
    this.#facts.run = shown;
  }
}

customElements.define("tb-job-page", JobPage);
