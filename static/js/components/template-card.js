// @ts-check
/** One study that is ready to run: its drawing, its size, one button. Emits `run`. */
import { h, s, show } from "../dom.js";
import { number, roughly, speed } from "../format.js";
import { link } from "../router.js";
import { Elevation } from "./elevation.js";

/** @typedef {import("../types.js").Template} Template */

export class TemplateCard extends HTMLElement {
  /** @type {Template | null} */
  #template = null;
  #run = h("button", { class: "primary", type: "button", onclick: () => this.#ask() });

  /** @param {Template} template */
  set template(template) {
    this.#template = template;
    const drawing = /** @type {Elevation} */ (h("tb-elevation"));
    drawing.scope = template.kind === "modes" ? (template.study.modes?.part ?? "viaduct") : "crossing";
    drawing.study = template.study;
    this.classList.add("card", "template");
    this.#run.setAttribute("aria-label", `Run ${template.title}`);
    this.busy = false;
    show(
      this,
      h("div", { class: "picture" }, drawing),
      h(
        "div",
        { class: "words" },
        h("h2", null, template.title),
        h("p", { class: "soft" }, template.description),
        h("dl", { class: "facts" }, facts(template)),
        h(
          "div",
          { class: "row" },
          this.#run,
          h("a", { class: "button", href: link("study", template.name), "aria-label": `Customise ${template.title}` }, "Customise"),
        ),
      ),
    );
  }

  /** Whether it is on its way to the queue. @param {boolean} busy */
  set busy(busy) {
    this.#run.disabled = busy;
    show(this.#run, busy ? "Starting…" : [play(), "Run"]);
  }

  #ask() {
    this.dispatchEvent(new CustomEvent("run", { detail: this.#template, bubbles: true }));
  }
}

function play() {
  return s("svg", { viewBox: "0 0 12 12", width: 12, height: 12, "aria-hidden": "true" }, s("path", { d: "M2 1 L11 6 L2 11 Z", fill: "currentColor" }));
}

/** @param {Template} template */
function facts({ kind, study, estimate }) {
  return [
    kind === "modes" ? pair("Modes", `up to ${number(study.modes?.count)}`) : speeds(study.sweep?.speeds ?? []),
    pair("Unknowns", number(estimate?.unknowns, 2)),
    pair("Time", roughly(estimate?.seconds)),
  ];
}

/** One speed, or the span of several. @param {number[]} values [m/s] */
function speeds(values) {
  if (values.length < 2) return pair("Speed", values.length ? speed(values[0]) : "–");
  const [low, high] = [Math.min(...values), Math.max(...values)].map((value) => speed(value));
  return pair(`${values.length} speeds`, `${low.replace(" km/h", "")} to ${high}`);
}

/**
 * @param {string} term
 * @param {string} value
 */
function pair(term, value) {
  return h("div", null, h("dt", null, term), h("dd", null, value));
}

customElements.define("tb-template-card", TemplateCard);
