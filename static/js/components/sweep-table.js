// @ts-check
/** The verdict of each speed of a sweep; a press on a speed shows its run. Emits `choose` {run}. */
import { h, show } from "../dom.js";
import { besideLimit, speed, unitText } from "../format.js";

/** @typedef {import("../job-words.js").Judged} Judged */

export class SweepTable extends HTMLElement {
  /**
   * @param {Judged[]} judged one verdict of each run
   * @param {string} chosen id of the run that is shown
   */
  bind(judged, chosen) {
    this.classList.add("card", "sweep");
    const unit = unitText(judged[0].verdict.unit);
    const heads = ["Speed", `Value [${unit}]`, `Limit [${unit}]`, "at x, y [m]", "t [s]", ""];
    show(
      this,
      h("h2", null, heading(judged)),
      h(
        "div",
        { class: "scroll", tabindex: 0, role: "region", "aria-label": "Verdicts of the sweep" },
        h(
          "table",
          null,
          h("thead", null, h("tr", null, heads.map((text) => h("th", { scope: "col" }, text)))),
          h("tbody", null, inOrder(judged).map((item) => this.#row(item, chosen))),
        ),
      ),
    );
  }

  /**
   * @param {Judged} item
   * @param {string} chosen
   */
  #row({ run, verdict }, chosen) {
    const choose = () => this.dispatchEvent(new CustomEvent("choose", { detail: { run }, bubbles: true }));
    const button = h("button", { type: "button", class: "link", onclick: choose }, speed(verdict.speed));
    return h(
      "tr",
      { "aria-current": run === chosen && "true" },
      h("th", { scope: "row" }, button),
      h("td", null, besideLimit(verdict.value, verdict.limit)),
      h("td", null, String(verdict.limit)),
      h("td", null, `${verdict.place.x.toFixed(1)}, ${verdict.place.y.toFixed(2)}`.replaceAll("-", "−")),
      h("td", null, verdict.time.toFixed(3)),
      h("td", { class: verdict.exceeds ? "exceeds" : "within" }, verdict.exceeds ? "exceeds" : "within"),
    );
  }
}

/** @param {Judged[]} judged */
const inOrder = (judged) => judged.toSorted((a, b) => a.verdict.speed - b.verdict.speed);

/** @param {Judged[]} judged */
function heading(judged) {
  const above = judged.filter((item) => item.verdict.exceeds).length;
  const speeds = `${judged.length} speed${judged.length > 1 ? "s" : ""}`;
  if (above === 0) return `Within the limit at ${judged.length > 1 ? "each of " : ""}${speeds} computed`;
  return `Exceeds the limit at ${above} of ${speeds} computed`;
}

customElements.define("tb-sweep-table", SweepTable);
