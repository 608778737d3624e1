// @ts-check
/** One job: its state, its verdict, and the desk with 3D view, plots and files of one of its runs. */
import { JobDesk } from "../components/job-desk.js";
import { JobHead } from "../components/job-head.js";
import { JobTrouble } from "../components/job-trouble.js";
import { complaint, verdictBars, verdictsOf } from "../components/job-results.js";
import { RunProgress } from "../components/run-progress.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { actOn } from "../job-actions.js";
import { begunAgain, worst } from "../job-words.js";
import { link, parse } from "../router.js";
import { RunView } from "../run-view.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../job-words.js").Judged} Judged */
/** @typedef {import("../router.js").Route} Route */

const ACTIVE = new Set(["queued", "running"]);

export class JobPage extends HTMLElement {
  /** @type {Route} */
  route = { name: "jobs", parts: [], query: new URLSearchParams() };
  #ended = new AbortController();
  /** @type {Job | null} */
  #known = null;
  /** The run that the page proposes while nobody has chosen one. */
  #proposed = "";
  #library = "";
  /** @type {Judged[]} */
  #judged = [];
  /** @type {RunView | null} */
  #view = null;
  #head = /** @type {JobHead} */ (h("tb-job-head", { class: "job-head" }));
  #state = h("div", { class: "stack", "aria-live": "polite" });
  #trouble = /** @type {JobTrouble} */ (h("tb-job-trouble", { hidden: true }));
  #progress = /** @type {RunProgress} */ (h("tb-run-progress", { hidden: true }));
  #results = h("div", { class: "stack", "aria-live": "polite" });
  #desk = /** @type {JobDesk} */ (h("tb-job-desk", { hidden: true }));

  connectedCallback() {
    const signal = this.#ended.signal;
    this.#view = new RunView(this.route.query);
    const home = h("a", { href: link("home") }, "Home");
    show(
      this,
      h("nav", { class: "crumb", "aria-label": "Path" }, home, " / ", h("a", { href: link("jobs") }, "Jobs"), " / This job"),
      this.#head,
      this.#state,
      this.#trouble,
      this.#progress,
      this.#results,
      this.#desk,
    );
    this.addEventListener("act", (event) => void this.#ask(() => actOn(/** @type {CustomEvent} */ (event).detail.action, this.#id)));
    this.addEventListener("prioritise", (event) => void this.#ask(() => api.prioritise(this.#id, /** @type {CustomEvent} */ (event).detail.priority)));
    this.addEventListener("choose", (event) => this.#view?.set({ run: /** @type {CustomEvent} */ (event).detail.run }));
    this.#view.watch(["run"], () => this.#known && this.#enter(this.#known), signal);
    addEventListener("hashchange", () => this.#reopen(), { signal });
    void this.#load(signal);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  get #id() {
    return this.route.parts[0];
  }

  /** The run that is shown. @returns {string} */
  get #run() {
    const chosen = this.#view?.look.run ?? "";
    const runs = this.#known?.runs ?? [];
    return (runs.find(({ id }) => id === chosen) ?? runs.find(({ id }) => id === this.#proposed) ?? runs.find(({ progress }) => progress?.step) ?? runs[0])?.id ?? "";
  }

  /** @param {AbortSignal} signal */
  async #load(signal) {
    try {
      this.#library = (await store.get("meta")).plotly_url;
      const job = await api.job(this.#id);
      if (signal.aborted) return;
      this.#update(job);
      store.watch(`job:${job.id}`, (news) => this.#update(news), signal);
    } catch (error) {
      const unknown = /** @type {any} */ (error).status === 404;
      show(this.#state, complaint(unknown ? "There is no such job here. It may have been removed." : error));
    }
  }

  /** Somebody opened a link to another picture of this job. */
  #reopen() {
    const route = parse(location.hash);
    if (route.name !== "jobs" || route.parts[0] !== this.#id) return;
    const fresh = new JobPage();
    fresh.route = route;
    this.replaceWith(fresh);
  }

  /** @param {Job} job */
  #update(job) {
    const before = this.#known;
    // An answer that was overtaken by the event stream must not turn the time back; a retry may.
    if (before && !ACTIVE.has(before.state) && ACTIVE.has(job.state) && !begunAgain(before, job)) return;
    this.#known = job;
    const percent = Math.floor((job.progress?.fraction ?? 0) * 100);
    document.title = `${job.state === "running" && percent ? `${percent} % · ` : ""}${job.name} · Trainbridge`;
    const active = ACTIVE.has(job.state);
    this.#progress.hidden = !active;
    if (active) this.#progress.job = job;
    if (before?.state !== job.state || ended(before) !== ended(job)) this.#enter(job);
    if (!this.#desk.hidden) void this.#desk.update(job, this.#run);
  }

  /**
   * A new state, or another run: its face.
   *
   * @param {Job} job
   */
  #enter(job) {
    this.#head.bind(job, this.#run);
    this.#trouble.job = job;
    show(this.#state);
    // Of a finished sweep, the worst speed is known only when all verdicts are read.
    const proposes = job.runs.length > 1 && !ACTIVE.has(job.state) && !this.#view?.look.run && !this.#proposed;
    if (!proposes) this.#openDesk(job);
    void this.#finish(job);
  }

  /** @param {Job} job */
  #openDesk(job) {
    const run = this.#run;
    if (!this.#desk.hidden || !run || !this.#view) return;
    this.#desk.hidden = false;
    this.#desk.bind({ job, run, view: this.#view, library: this.#library });
  }

  /** What there is of the runs that are done, of a sweep also while others still compute. @param {Job} job */
  async #finish(job) {
    const done = job.runs.filter((run) => run.state === "done");
    if (!done.length) {
      show(this.#results);
      return this.#openDesk(job);
    }
    try {
      if (job.runs.length > 1) await this.#judge(job, done.map((run) => run.id));
      this.#openDesk(job);
      const id = this.#run;
      void this.#desk.update(job, id);
      /** @type {Run | null} */
      const run = done.some((item) => item.id === id) ? await api.run(id) : null;
      if (id !== this.#run || !this.isConnected) return;
      show(this.#results, run && verdictBars(run));
      this.#desk.result = run;
    } catch (error) {
      show(this.#state, complaint(error));
    }
  }

  /**
   * The verdict of each speed; the worst is proposed.
   *
   * @param {Job} job
   * @param {string[]} done ids
   */
  async #judge(job, done) {
    if (this.#judged.length !== done.length) this.#judged = await verdictsOf(done);
    this.#desk.judged = this.#judged;
    if (this.#judged.length && !ACTIVE.has(job.state)) this.#proposed = worst(this.#judged).run;
    else this.#proposed ||= done[0];
    this.#head.bind(job, this.#run);
  }

  /**
   * Asks the server for something, and shows what came of it.
   *
   * @param {() => Promise<Job | null>} request
   */
  async #ask(request) {
    this.#head.busy = true;
    try {
      const job = await request();
      if (job) this.#update(job);
      show(this.#state);
    } catch (error) {
      show(this.#state, complaint(error));
    }
    this.#head.busy = false;
  }
}

/** How many runs have ended. @param {Job | null} job */
const ended = (job) => job?.runs.filter((run) => !ACTIVE.has(run.state)).length;

customElements.define("tb-job-page", JobPage);
