// @ts-check
/** The runs of a comparison. Emits `base` {run}, `leave` {run} and `join` {run}. */
import { h, show } from "../dom.js";
import { stateText } from "../format.js";
import { MOST } from "../compare-words.js";
import { link } from "../router.js";
import { ComparePicker } from "./compare-picker.js";

/** @typedef {import("../types.js").ComparedRun} ComparedRun */

export class CompareRuns extends HTMLElement {
  #picker = /** @type {ComparePicker} */ (h("tb-compare-picker"));
  #adding = h("details", { class: "compare-adding", ontoggle: () => this.#adding.open && void this.#picker.load() }, h("summary", null, "Add runs"), this.#picker);
  #list = h("ul", { class: "compare-runs" });

  connectedCallback() {
    this.classList.add("card", "compare-who");
    show(this, this.#list, this.#adding);
  }

  /**
   * @param {ComparedRun[]} runs the baseline first
   * @param {string[]} names
   */
  bind(runs, names) {
    const chosen = this.#list.contains(document.activeElement) && document.activeElement?.getAttribute("value");
    show(this.#list, runs.map((run, index) => this.#item(run, names[index], index)));
    if (chosen) /** @type {HTMLElement | null} */ (this.#list.querySelector(`input[value="${chosen}"]`))?.focus();
    this.#adding.hidden = runs.length >= MOST;
    if (runs.length < 2) this.#adding.open = true;
    this.#picker.chosen = runs.map((run) => run.id);
  }

  /**
   * @param {ComparedRun} run
   * @param {string} name
   * @param {number} index
   */
  #item(run, name, index) {
    const send = (/** @type {string} */ what) => () => this.dispatchEvent(new CustomEvent(what, { detail: { run: run.id }, bubbles: true }));
    return h(
      "li",
      null,
      h("label", { class: "inline" }, h("input", { type: "radio", name: "compare-base", value: run.id, checked: index === 0, onchange: send("base") }), h("span", { class: "sr" }, "Baseline: "), h("span", { class: "compare-name" }, name)),
      index === 0 && h("span", { class: "tag running" }, "baseline"),
      run.state !== "done" && h("span", { class: `tag ${run.state}` }, stateText(run.state)),
      h("span", { class: "compare-tools" },
        h("a", { class: "small", href: `${link("jobs", run.job)}?run=${encodeURIComponent(run.id)}`, "aria-label": `Open ${name}` }, "Open"),
        h("button", { type: "button", class: "link small", onclick: send("leave"), "aria-label": `Remove ${name}` }, "Remove")),
    ); // prettier-ignore
  }
}

customElements.define("tb-compare-runs", CompareRuns);
