// @ts-check
/** One job: its state, its verdict, and the instrument of 3D view, plots and one time cursor. */
import { JobHead } from "../components/job-head.js";
import { ModesTable } from "../components/modes-table.js";
import { RunFacts } from "../components/run-facts.js";
import { RunInstrument } from "../components/run-instrument.js";
import { RunProgress } from "../components/run-progress.js";
import { SweepTable } from "../components/sweep-table.js";
import { VerdictBar } from "../components/verdict-bar.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { worst } from "../job-words.js";
import { momentOfInterest } from "../moment.js";
import { store } from "../store.js";
import { trouble } from "../trouble.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../job-words.js").Judged} Judged */

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
  #head = /** @type {JobHead} */ (h("tb-job-head", { class: "job-head" }));
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
    this.addEventListener("cancel", () => void this.#cancel());
    this.addEventListener("choose", (event) => this.#choose(/** @type {CustomEvent} */ (event).detail.run));
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
      show(this.#state, complaint(unknown ? "There is no such job here. It may have been removed." : error));
    }
  }

  /** @param {Job} job */
  #update(job) {
    const before = this.#known;
    // An answer that was overtaken by the event stream must not turn the time back.
    if (before && !ACTIVE.has(before.state) && ACTIVE.has(job.state)) return;
    this.#known = job;
    const percent = Math.floor((job.progress?.fraction ?? 0) * 100);
    document.title = `${job.state === "running" && percent ? `${percent} % · ` : ""}${job.name} · Trainbridge`;
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
    this.#head.bind(job, this.#chosen);
    if (ACTIVE.has(job.state)) show(this.#state);
    else void this.#finish(job);
  }

  /** @param {string} run */
  #choose(run) {
    const job = this.#known;
    if (!job || run === this.#chosen) return;
    this.#chosen = run;
    const fresh = /** @type {RunInstrument} */ (h("tb-run-instrument", { hidden: true }));
    this.#instrument.replaceWith(fresh);
    this.#instrument = fresh;
    this.query = new URLSearchParams();
    this.#head.bind(job, run);
    this.#follow(job);
    if (!ACTIVE.has(job.state)) void this.#finish(job);
  }

  async #cancel() {
    this.#head.cancelling = true;
    try {
      this.#update((await api.cancel(this.job)) ?? (await api.job(this.job)));
    } catch (error) {
      this.#head.cancelling = false;
      show(this.#state, complaint(error));
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

  /** What there is of a job that has ended: of a sweep some runs may be done. @param {Job} job */
  async #finish(job) {
    show(this.#state, trouble(job));
    const done = job.runs.filter((run) => run.state === "done");
    if (!done.length) return;
    try {
      const judged = done.length > 1 ? await verdictsOf(done.map((run) => run.id)) : [];
      if (!this.#chosen && judged.length) return this.#choose(worst(judged).run);
      const shown = done.find((run) => run.id === this.#chosen) ?? (this.#chosen ? null : done[0]);
      /** @type {Run | null} */
      const run = shown && (await api.run(shown.id));
      show(this.#state, trouble(job), judged.length > 0 && this.#sweep(judged), run && results(run));
      this.#facts.hidden = !run;
      if (run) this.#explain(run);
    } catch (error) {
      show(this.#state, trouble(job), complaint(error));
    }
  }

  /** @param {Judged[]} judged */
  #sweep(judged) {
    const table = /** @type {SweepTable} */ (h("tb-sweep-table"));
    table.bind(judged, this.#chosen);
    return table;
  }

  /** @param {Run} run */
  #explain(run) {
    const moment = momentOfInterest(run);
    if (moment !== null) this.#instrument.suggest(moment);
    this.#facts.run = run;
  }
}

/** @param {unknown} error */
function complaint(error) {
  const text = error instanceof Error ? error.message : String(error);
  return h("div", { class: "notice bad", role: "alert" }, h("p", null, text));
}

/**
 * The deciding verdict of each run that has one.
 *
 * @param {string[]} runs
 * @returns {Promise<Judged[]>}
 */
async function verdictsOf(runs) {
  const answers = await Promise.all(runs.map((run) => api.runVerdicts(run)));
  return answers.flatMap((answer, index) => (answer.items.length ? [{ run: runs[index], verdict: answer.items[0] }] : []));
}

/** Verdict or modes of one run, or why there is neither. @param {Run} run */
function results(run) {
  const summary = run.summary ?? {};
  if (summary.modes) {
    const table = /** @type {ModesTable} */ (h("tb-modes-table"));
    table.modes = summary.modes;
    return table;
  }
  const bars = (run.verdicts ?? []).map((verdict) => {
    const bar = /** @type {VerdictBar} */ (h("tb-verdict-bar"));
    bar.bind(verdict, summary.facts?.mesh_accuracy ?? []);
    return bar;
  });
  if (bars.length || !summary.unjudged) return bars;
  return h("div", { class: "notice" }, h("p", null, summary.unjudged));
}

customElements.define("tb-job-page", JobPage);
