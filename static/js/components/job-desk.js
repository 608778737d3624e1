// @ts-check
/**
 * What is seen of one run of a job: the instrument, and under it the tabs with plots, inputs, log and
 * files. Another run of the same job takes the place of the first; the viewing session stays.
 */
import { Elevation } from "./elevation.js";
import { JobPanels } from "./job-panels.js";
import { RunInstrument } from "./run-instrument.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { runFigure } from "../figures.js";
import { FIRST_FIGURES } from "../job-tabs.js";
import { momentsOfInterest } from "../moment.js";
import { runExtent, shownExtent } from "../run-extent.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../types.js").FigureItem} FigureItem */
/** @typedef {import("../run-view.js").RunView} RunView */

/** Tabs that need the whole page for themselves. */
const ALONE = new Set(["inputs", "log", "files"]);
/** Live curves are fetched again at most this often. [ms] */
const PACE = 1500;

export class JobDesk extends HTMLElement {
  /** @type {Job | null} */
  #job = null;
  #run = "";
  /** @type {RunView | null} */
  #view = null;
  #library = "";
  /** @type {FigureItem[]} */
  #figures = FIRST_FIGURES;
  /** @type {Run | null} */
  #result = null;
  /** @type {Promise<void> | null} */
  #opening = null;
  /** Whether what opens has opened: everything below is bound to a run. */
  #opened = false;
  /** Whether the instrument shows something. */
  #ready = false;
  #refreshing = false;
  /** Whether something changed while the curves were on their way. */
  #again = false;
  #drawnAt = Number.NEGATIVE_INFINITY;
  #ended = new AbortController();
  #side = /** @type {Elevation} */ (h("tb-elevation"));
  /** The study from the side, until there is more to see. */
  #drawing = h("div", { class: "card drawing", hidden: true }, this.#side);
  #partial = h("p", { class: "notice wait", hidden: true, role: "status" });
  #instrument = /** @type {RunInstrument} */ (h("tb-run-instrument", { hidden: true }));
  #panels = /** @type {JobPanels} */ (h("tb-job-panels"));
  #whole = h("button", { type: "button", class: "quiet whole", hidden: true, onclick: () => this.#view?.set({ window: null }) }, "Show the whole run");

  /** @param {{ job: Job, run: string, view: RunView, library: string }} options */
  bind({ job, run, view, library }) {
    this.#job = job;
    this.#run = run;
    this.#view = view;
    this.#library = library;
    show(this, this.#drawing, this.#partial, this.#instrument, this.#whole, this.#panels);
    this.#panels.bind({ job, run, view, library, figures: this.#figures });
    view.watch(["tab", "window"], () => this.#arrange(), this.#ended.signal);
    void this.#draw(job.id);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /**
   * The job as it is now, and which of its runs is shown.
   *
   * @param {Job} job
   * @param {string} run
   */
  async update(job, run) {
    const before = this.#job?.runs.find(({ id }) => id === run)?.state;
    this.#job = job;
    this.#panels.job = job;
    if (run !== this.#run) this.#switch(run);
    const item = job.runs.find(({ id }) => id === run);
    const begun = item && ((item.progress?.step ?? 0) > 0 || item.state === "done");
    if (!begun) return void (this.#partial.hidden = true);
    this.#opening ??= this.#open();
    await this.#opening;
    if (run !== this.#run || !this.isConnected) return;
    this.#mark(item);
    if (this.#ready) this.#instrument.progress(item.state, item.progress?.simulated_time ?? null);
    const news = before !== item.state;
    if (news || performance.now() - this.#drawnAt > PACE) void this.#refresh(news);
  }

  /** What the shown run has come to. @param {Run | null} run */
  set result(run) {
    this.#result = run;
    if (this.#ready && this.#job?.kind !== "modes") this.#instrument.moments = run ? momentsOfInterest(run) : [];
    this.#panels.found = { result: run };
  }

  /** The verdicts of a sweep. @param {import("../job-words.js").Judged[]} judged */
  set judged(judged) {
    this.#panels.found = { judged };
  }

  /** @param {string} job */
  async #draw(job) {
    const study = await api.jobStudy(job).catch(() => null);
    if (!study || !this.isConnected) return;
    if (this.#view) this.#view.slabLevel = study.viaduct?.slab_level ?? 0;
    this.#instrument.viewer.stills.study = study;
    this.#side.study = study;
    this.#drawing.hidden = this.#opening !== null;
  }

  /** The first steps are there: the instrument comes to life. */
  async #open() {
    const modal = this.#job?.kind === "modes";
    const { figures, frames, interval } = await shownExtent(() => this.#run);
    if (!this.isConnected) return;
    const view = /** @type {RunView} */ (this.#view);
    this.#figures = figures;
    this.#drawing.hidden = true;
    this.#ready = !modal || frames > 0;
    if (this.#ready) {
      this.#instrument.bind({ run: this.#run, view, library: this.#library, modal });
      if (!modal) view.cursor.interval = interval;
    }
    this.#panels.found = { animated: this.#ready };
    this.#panels.open({ run: this.#run, figures });
    this.#opened = true;
    if (this.#result) this.result = this.#result;
    this.#arrange();
  }

  /** @param {string} run */
  #switch(run) {
    this.#run = run;
    this.#result = null;
    this.#view?.set({ window: null, time: null });
    if (!this.#opened) return; // what opens shows the run that was chosen last
    if (this.#ready) this.#instrument.run = run;
    this.#panels.open({ run, figures: this.#figures });
    void this.#refresh(true);
    void runExtent(run).then(({ interval }) => this.#view && run === this.#run && interval && (this.#view.cursor.interval = interval));
  }

  /** Fetches what is seen again. @param {boolean} news whether what is on its way may lack something */
  async #refresh(news) {
    this.#again ||= news;
    if (this.#refreshing) return;
    this.#refreshing = true;
    try {
      do {
        this.#again = false;
        this.#drawnAt = performance.now();
        await Promise.all([this.#extent(), this.#panels.refresh()]);
      } while (this.#again && this.isConnected);
    } finally {
      this.#refreshing = false; // a fault must not be the end of all live curves
    }
  }

  async #extent() {
    if (this.#job?.kind === "modes") return;
    const run = this.#run;
    // Without a curve yet, the next refresh asks again.
    const figure = await runFigure(run, "displacement").json({ points: 60 }).catch(() => null);
    if (figure && run === this.#run && this.isConnected) this.#instrument.overview = figure;
  }

  /** Marks what is not a whole run. @param {import("../types.js").RunItem} item */
  #mark({ state, progress }) {
    const ended = state !== "done" && state !== "running" && state !== "queued";
    this.#partial.hidden = !ended;
    const until = progress?.simulated_time ? ` up to t = ${progress.simulated_time.toFixed(3)} s` : "";
    if (ended) show(this.#partial, h("strong", null, "Partial data"), `: the computation ended early; curves and 3D view show what there is${until}. No verdict.`);
  }

  #arrange() {
    const alone = ALONE.has(this.#panels.tab);
    this.#instrument.hidden = alone || !this.#ready;
    this.#whole.hidden = alone || !this.#ready || !this.#view?.look.window;
    this.classList.toggle("beside", this.#job?.kind === "modes" && !this.#instrument.hidden);
  }
}

customElements.define("tb-job-desk", JobDesk);
