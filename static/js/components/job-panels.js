// @ts-check
/**
 * The tabs of a job and what stands in each. Which tab is open is part of what is looked at; plots
 * that nobody sees are not fetched.
 */
import { FigureStack } from "./figure-stack.js";
import { additionOf, contentOf } from "./job-contents.js";
import { JobLog } from "./job-log.js";
import { JobTabs } from "./job-tabs.js";
import { ModesTable } from "./modes-table.js";
import { h, show } from "../dom.js";
import { FIRST_TABS, tabsOf } from "../job-tabs.js";
import { isActive } from "../job-words.js";

/** @typedef {import("./job-contents.js").Shown} Shown */
/** @typedef {import("./job-contents.js").Found} Found */

/** Tabs that stay as they are where another run is shown. */
const OF_THE_JOB = new Set(["sweep", "inputs", "log"]);

export class JobPanels extends HTMLElement {
  /** @type {Shown | null} */
  #shown = null;
  /** @type {Found} */
  #found = { result: null, judged: [], animated: false };
  /** Whether there are curves to fetch. */
  #begun = false;
  #ended = new AbortController();
  #tabs = /** @type {JobTabs} */ (h("tb-job-tabs"));

  /** @param {Shown} shown */
  bind(shown) {
    const { view } = shown;
    this.#shown = shown;
    show(this, this.#tabs);
    this.#tabs.bind({ tabs: FIRST_TABS, chosen: view.look.tab, build: (id) => this.#build(id) });
    this.#tabs.addEventListener("tab", (event) => view.set({ tab: /** @type {CustomEvent} */ (event).detail.id }));
    this.addEventListener("mode", (event) => view.set({ mode: /** @type {CustomEvent} */ (event).detail.mode }));
    const signal = this.#ended.signal;
    view.watch(["tab"], ({ tab }) => this.#turn(tab), signal);
    view.watch(["mode"], ({ mode }) => this.#mark(mode), signal);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** The open tab. @returns {string} */
  get tab() {
    return this.#tabs.chosen;
  }

  /** The job as it is now. @param {import("../types.js").Job} job */
  set job(job) {
    const shown = /** @type {Shown} */ (this.#shown);
    const more = doneRuns(shown.job) !== doneRuns(job);
    this.#shown = { ...shown, job };
    for (const log of this.querySelectorAll("tb-job-log")) /** @type {JobLog} */ (log).active = isActive(job);
    if (shown.job.state !== job.state) this.#tabs.forget("files");
    if (more) this.#stacks((stack, id) => id === "sweep" && void stack.refresh());
  }

  /**
   * Which run is shown and what there is to draw of it; from now on there are curves.
   *
   * @param {Pick<Shown, "run" | "figures">} change
   */
  open(change) {
    const shown = { .../** @type {Shown} */ (this.#shown), ...change };
    this.#shown = shown;
    this.#begun = true;
    const tabs = tabsOf(shown.job, shown.figures);
    this.#tabs.tabs = tabs;
    for (const { id } of tabs) if (!OF_THE_JOB.has(id)) this.#tabs.forget(id);
    this.#turn(shown.view.look.tab);
  }

  /** What the run and the sweep came to. @param {Partial<Found>} found */
  set found(found) {
    this.#found = { ...this.#found, ...found };
    for (const id of ["overview", "vehicle", "sweep"]) this.#add(id);
  }

  /** Fetches the curves that are seen again. */
  async refresh() {
    /** @type {Promise<void>[]} */
    const waits = [];
    this.#stacks((stack) => waits.push(stack.refresh()));
    await Promise.all(waits);
  }

  /** @param {string} tab */
  #turn(tab) {
    this.#tabs.choose(tab);
    if (this.tab === "files") this.#tabs.forget("files"); // its picture is of the time as it is now
    this.#arrange();
  }

  #arrange() {
    this.#stacks((stack, id) => (stack.shown = this.#begun && id === this.tab));
  }

  /** @param {string} id */
  #build(id) {
    queueMicrotask(() => {
      this.#add(id);
      this.#arrange();
    });
    return contentOf(id, /** @type {Shown} */ (this.#shown));
  }

  /** @param {string} id */
  #add(id) {
    const place = this.#tabs.panel(id)?.querySelector(".addition");
    if (!place || !this.#shown) return;
    const focused = place.contains(document.activeElement) ? document.activeElement?.textContent : null;
    show(place, additionOf(id, this.#shown, this.#found));
    if (focused) [...place.querySelectorAll("button")].find((button) => button.textContent === focused)?.focus();
  }

  /** @param {number} mode */
  #mark(mode) {
    for (const table of this.querySelectorAll("tb-modes-table")) /** @type {ModesTable} */ (table).chosen = mode;
  }

  /** @param {(stack: FigureStack, id: string) => void} act */
  #stacks(act) {
    const { job, figures } = /** @type {Shown} */ (this.#shown);
    for (const { id } of tabsOf(job, figures)) {
      const stack = this.#tabs.panel(id)?.querySelector("tb-figure-stack");
      if (stack) act(/** @type {FigureStack} */ (stack), id);
    }
  }
}

/** @param {import("../types.js").Job} job */
const doneRuns = (job) => job.runs.filter((run) => run.state === "done").length;

customElements.define("tb-job-panels", JobPanels);
