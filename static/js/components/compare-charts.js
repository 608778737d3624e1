// @ts-check
/** Histories of runs laid over one another, and their envelopes. Emits `look` with what was changed. */
import { Chart } from "./chart.js";
import { chosenChannel } from "../compare-words.js";
import { h, show } from "../dom.js";
import { compareFigure } from "../figures.js";

/** @typedef {import("../types.js").ComparedRun} ComparedRun */
/** @typedef {import("../types.js").Channel} Channel */

/** How histories can be drawn: value and title. @type {[string, string][]} */
const CURVES = [
  ["filtered", "Filtered"],
  ["raw", "As computed"],
  ["position", "Over the train's position"],
];
/** @type {[string, string][]} */
const ENVELOPES = [
  ["displacement", "Displacement"],
  ["acceleration", "Acceleration"],
];

/**
 * @param {string | null} variant
 * @param {[string, string][]} known
 */
const asked = (variant, known) => (variant && known.some(([name]) => name === variant) ? { variant } : {});

/**
 * The zoomed window of an address. [s]
 *
 * @param {URLSearchParams} look
 */
function windowOf(look) {
  const [from, to] = ["from", "to"].map((key) => Number.parseFloat(look.get(key) ?? ""));
  return Number.isFinite(from) && Number.isFinite(to) && from < to ? { from, to } : null;
}

export class CompareCharts extends HTMLElement {
  #histories = /** @type {Chart} */ (h("tb-chart"));
  #envelope = /** @type {Chart} */ (h("tb-chart"));

  connectedCallback() {
    this.#histories.addEventListener("zoom", (event) => {
      const window = /** @type {CustomEvent} */ (event).detail;
      this.#histories.window = window;
      this.#tell({ from: window?.from ?? null, to: window?.to ?? null });
    });
    this.#histories.addEventListener("variant", (event) => this.#tell({ curves: /** @type {CustomEvent} */ (event).detail.variant }));
    this.#envelope.addEventListener("variant", (event) => this.#tell({ envelope: /** @type {CustomEvent} */ (event).detail.variant }));
  }

  /**
   * @param {ComparedRun[]} runs the baseline first
   * @param {Channel[]} channels that all of them have
   * @param {{ library: string, look: URLSearchParams }} options
   */
  bind(runs, channels, { library, look }) {
    const recorded = runs.filter((run) => run.has_histories).map((run) => run.id);
    if (!recorded.length) {
      show(this);
      return;
    }
    const chosen = chosenChannel(channels, look.get("channel"));
    const none = h("p", { class: "card sheet soft" }, "These runs have no history in common: their trains or structures differ too much.");
    show(this, h("section", { class: "stack", "aria-label": "Histories" }, channels.length ? [this.#choice(channels, chosen), this.#histories] : none), this.#envelope);
    if (channels.length) this.#drawHistories(recorded, chosen, library, look);
    this.#envelope.bind({
      source: compareFigure(recorded, "envelope"),
      title: "Envelopes along the axis",
      library,
      variants: ENVELOPES,
      query: asked(look.get("envelope"), ENVELOPES),
      empty: "These runs have no envelopes to compare.",
    });
    void this.#envelope.refresh();
  }

  /**
   * @param {string[]} runs
   * @param {string} channel
   * @param {string} library
   * @param {URLSearchParams} look
   */
  #drawHistories(runs, channel, library, look) {
    this.#histories.bind({
      source: compareFigure(runs, "histories"),
      title: "Histories",
      library,
      window: windowOf(look),
      variants: CURVES,
      query: { channels: [channel], ...asked(look.get("curves"), CURVES) },
      empty: "These histories cannot be drawn yet.",
    });
    void this.#histories.refresh();
  }

  /** @param {Record<string, string | number | null>} change */
  #tell(change) {
    this.dispatchEvent(new CustomEvent("look", { detail: change, bubbles: true }));
  }

  /**
   * @param {Channel[]} channels
   * @param {string} chosen
   */
  #choice(channels, chosen) {
    const groups = [...new Set(channels.map((item) => item.group))];
    const option = (/** @type {Channel} */ item) => h("option", { value: item.name, selected: item.name === chosen }, item.title || item.name);
    const select = h(
      "select",
      { id: "compare-channel", onchange: () => this.#choose(select.value) },
      groups.map((group) => h("optgroup", { label: group }, channels.filter((item) => item.group === group).map(option))),
    );
    return h("div", { class: "row compare-channel" }, h("label", { for: "compare-channel" }, "History"), select);
  }

  /** @param {string} channel */
  #choose(channel) {
    this.#histories.query = { channels: [channel] };
    this.#tell({ channel });
  }
}

customElements.define("tb-compare-charts", CompareCharts);
