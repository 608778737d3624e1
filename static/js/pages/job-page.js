// @ts-check
/** One job: its state, its verdict, and the desk with 3D view, plots and files of one of its runs. */
import { JobDesk } from "../components/job-desk.js";
import { JobHead } from "../components/job-head.js";
import { JobTrouble } from "../components/job-trouble.js";
import { Verdicts, complaint, verdictBars } from "../components/job-results.js";
import { RunProgress } from "../components/run-progress.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { actOn } from "../job-actions.js";
import { begunAgain, endedRuns, isActive, shownRun, tabTitle, worst } from "../job-words.js";
import { link, parse } from "../router.js";
import { RunView } from "../run-view.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../router.js").Route} Route */

export class JobPage extends HTMLElement {
  /** @type {Route} */
  route = { name: "jobs", parts: [], query: new URLSearchParams() };
  #ended = new AbortController();
  /** @type {Job | null} */
  #known = null;
  /** The run that the page proposes while nobody has chosen one. */
  #proposed = "";
  /** Whether the job could not be asked for. */
  #missed = false;
  #library = "";
  #verdicts = new Verdicts();
  #asked = 0; // for results: only the last answer counts
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
    show(
      this,
      h("nav", { class: "crumb", "aria-label": "Path" }, h("a", { href: link("home") }, "Home"), " / ", h("a", { href: link("jobs") }, "Jobs"), " / This job"),
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
    // A server that was away when the page opened may be back.
    store.watch("connected", (connected) => connected && this.#missed && void this.#load(signal), signal);
  }

  disconnectedCallback() {
    this.#view?.close();
    this.#ended.abort();
  }

  get #id() {
    return this.route.parts[0];
  }

  /** The run that is shown. @returns {string} */
  get #run() {
    return shownRun(this.#known?.runs ?? [], this.#view?.look.run ?? "", this.#proposed);
  }

  /** @param {AbortSignal} signal */
  async #load(signal) {
    this.#missed = false;
    try {
      this.#library = (await store.get("meta")).plotly_url;
      const job = await api.job(this.#id);
      if (signal.aborted) return;
      show(this.#state);
      this.#update(job);
      store.watch(`job:${job.id}`, (news) => this.#update(news), signal);
    } catch (error) {
      if (signal.aborted) return;
      const unknown = /** @type {any} */ (error).status === 404;
      this.#missed = !unknown;
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
    if (before && !isActive(before) && isActive(job) && !begunAgain(before, job)) return;
    this.#known = job;
    document.title = tabTitle(job);
    this.#progress.hidden = !isActive(job);
    if (isActive(job)) this.#progress.job = job;
    if (before?.state !== job.state || endedRuns(before) !== endedRuns(job)) this.#enter(job);
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
    const proposes = job.runs.length > 1 && !isActive(job) && !this.#view?.look.run && !this.#proposed;
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
    const asked = (this.#asked += 1);
    const done = job.runs.filter((run) => run.state === "done");
    if (!done.length) {
      show(this.#results);
      return this.#openDesk(job);
    }
    try {
      const judged = job.runs.length > 1 ? await this.#verdicts.of(done) : [];
      if (asked !== this.#asked || !this.isConnected) return;
      if (job.runs.length > 1) this.#judge(job, judged, done[0].id);
      this.#openDesk(job);
      const id = this.#run;
      void this.#desk.update(job, id);
      /** @type {Run | null} */
      const run = done.some((item) => item.id === id) ? await api.run(id) : null;
      if (asked !== this.#asked || id !== this.#run || !this.isConnected) return;
      show(this.#results, run && verdictBars(run));
      this.#desk.result = run;
    } catch (error) {
      if (asked === this.#asked) show(this.#state, complaint(error));
    }
  }

  /**
   * The verdict of each speed; the worst is proposed.
   *
   * @param {Job} job
   * @param {import("../job-words.js").Judged[]} judged
   * @param {string} first run that is done
   */
  #judge(job, judged, first) {
    this.#desk.judged = judged;
    if (judged.length && !isActive(job)) this.#proposed = worst(judged).run;
    else this.#proposed ||= first;
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

customElements.define("tb-job-page", JobPage);
