// @ts-check
/** Runs side by side; the address holds which, the baseline and the history that is drawn. */
import { CompareCharts } from "../components/compare-charts.js";
import { CompareRuns } from "../components/compare-runs.js";
import { CompareTables } from "../components/compare-tables.js";
import { api } from "../api.js";
import { MOST, runNames, runsOf } from "../compare-words.js";
import { h, show } from "../dom.js";
import { parse, remember } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../types.js").Comparison} Comparison */

const NOTHING = { runs: [], inputs: [], results: [], channels: [], remarks: [] };

export class ComparePage extends HTMLElement {
  /** @type {import("../router.js").Route} */
  route = { name: "compare", parts: [], query: new URLSearchParams() };
  /** Ids, the baseline first. @type {string[]} */
  #runs = [];
  #runList = /** @type {CompareRuns} */ (h("tb-compare-runs"));
  #tables = /** @type {CompareTables} */ (h("tb-compare-tables"));
  #charts = /** @type {CompareCharts} */ (h("tb-compare-charts"));
  #said = h("div", { class: "stack", role: "status" });
  /** @type {AbortController | null} */
  #asking = null;

  connectedCallback() {
    document.title = "Compare · Trainbridge";
    this.#runs = runsOf(this.route.query);
    show(
      this,
      h("h1", null, "Compare"),
      h("p", { class: "soft lead" }, "Runs side by side: the inputs in which they differ, and every result against the baseline."),
      this.#runList,
      this.#said,
      this.#tables,
      this.#charts,
    );
    const on = (/** @type {string} */ name, /** @type {(run: string) => string[]} */ change) =>
      this.addEventListener(name, (event) => this.#become(change(/** @type {CustomEvent} */ (event).detail.run)));
    on("base", (run) => [run, ...this.#runs.filter((other) => other !== run)]);
    on("leave", (run) => this.#runs.filter((other) => other !== run));
    on("join", (run) => [...this.#runs, run].slice(0, MOST));
    this.addEventListener("look", (event) => {
      for (const [key, value] of Object.entries(/** @type {CustomEvent} */ (event).detail)) remember(key, value === null ? null : String(value));
    });
    void this.#open();
  }

  disconnectedCallback() {
    this.#asking?.abort();
  }

  /** @param {string[]} runs */
  #become(runs) {
    this.#runs = runs;
    remember("runs", runs.length ? runs.join(",") : null);
    remember("base", runs[0] ?? null);
    void this.#open();
  }

  async #open() {
    this.#asking?.abort();
    const asking = new AbortController();
    this.#asking = asking;
    try {
      const [meta, found] = await Promise.all([store.get("meta"), this.#runs.length ? api.compare(this.#runs, asking.signal) : NOTHING]);
      if (!asking.signal.aborted) this.#show(found, meta.plotly_url);
    } catch (error) {
      if (asking.signal.aborted) return;
      this.#runList.bind([], []);
      show(this.#said, h("div", { class: "notice bad" }, h("p", null, /** @type {Error} */ (error).message)));
      show(this.#tables);
      show(this.#charts);
    }
  }

  /**
   * @param {Comparison} found
   * @param {string} library
   */
  #show(found, library) {
    const names = runNames(found.runs);
    this.#runList.bind(found.runs, names);
    show(this.#said, found.runs.length < 2 ? few(found.runs.length) : found.remarks.map((text) => h("div", { class: "notice wait" }, h("p", null, text))));
    this.#tables.hidden = found.runs.length < 2;
    this.#charts.hidden = found.runs.length < 1;
    if (found.runs.length > 1) this.#tables.bind(found, names);
    this.#charts.bind(found.runs, found.channels, { library, look: parse(location.hash).query });
  }
}

/** @param {number} count */
function few(count) {
  const words = count ? "One run alone: add another one to compare it with." : "No run is chosen yet. Add some above, or tick them in the list of jobs.";
  return h("div", { class: "notice" }, h("p", null, words, " ", h("a", { href: "#/jobs" }, "Open the list of jobs")));
}

customElements.define("tb-compare-page", ComparePage);
