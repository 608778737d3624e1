// @ts-check
/** One study that is ready to run: its drawing, its size, one button. Emits `run`. */
import { h, s, show } from "../dom.js";
import { number, roughly, speed } from "../format.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Template} Template */
/** @typedef {import("../types.js").Report} Report */

export class TemplateCard extends HTMLElement {
  /** @type {Template | null} */
  #template = null;
  /** @type {HTMLElement | null} */
  #facts = null;
  /** @type {HTMLButtonElement | null} */
  #run = null;

  /** @param {Template} template */
  set template(template) {
    this.#template = template;
    this.#draw(template);
  }

  /** What the server's check said of it. @param {Report} report */
  set report(report) {
    if (this.#facts && this.#template) show(this.#facts, facts(this.#template, report.estimate));
  }

  /** Whether it is on its way to the queue. @param {boolean} busy */
  set busy(busy) {
    if (!this.#run) return;
    this.#run.disabled = busy;
    show(this.#run, busy ? "Starting…" : [play(), "Run"]);
  }

  /** @param {Template} template */
  #draw(template) {
    const drawing = /** @type {import("./elevation.js").Elevation} */ (h("tb-elevation"));
    drawing.study = template.study;
    this.classList.add("card", "template");
    this.#facts = h("dl", { class: "facts" }, facts(template, template.estimate ?? null));
    this.#run = h(
      "button",
      { class: "primary", type: "button", onclick: () => this.#ask(), "aria-label": `Run ${template.title}` },
      play(),
      "Run",
    );
    show(
      this,
      h("div", { class: "picture" }, drawing),
      h(
        "div",
        { class: "words" },
        h("h2", null, template.title),
        h("p", { class: "soft" }, template.description),
        this.#facts,
        h(
          "div",
          { class: "row" },
          this.#run,
          h("a", { class: "button", href: link("study", template.name), "aria-label": `Customise ${template.title}` }, "Customise"),
        ),
      ),
    );
  }

  #ask() {
    this.dispatchEvent(new CustomEvent("run", { detail: this.#template, bubbles: true }));
  }
}

function play() {
  return s("svg", { viewBox: "0 0 12 12", width: 12, height: 12, "aria-hidden": "true" }, s("path", { d: "M2 1 L11 6 L2 11 Z", fill: "currentColor" }));
}

/**
 * @param {Template} template
 * @param {import("../types.js").Estimate | null} estimate
 */
function facts(template, estimate) {
  const speeds = template.study.sweep?.speeds ?? [];
  return [
    pair("Speed", speeds.length > 1 ? `${speeds.length} speeds` : speeds.length ? speed(speeds[0]) : "–"),
    template.study.mesh_level && template.study.viaduct?.type !== "beam"
      ? pair("Mesh", template.study.mesh_level)
      : pair("Steps", estimate ? number(estimate.steps, 3) : "…"),
    pair("Unknowns", estimate ? number(estimate.unknowns, 2) : "…"),
    pair("Time", estimate ? roughly(estimate.seconds) : "…"),
  ];
}

/**
 * @param {string} term
 * @param {string} value
 */
function pair(term, value) {
  return h("div", null, h("dt", null, term), h("dd", null, value));
}

customElements.define("tb-template-card", TemplateCard);
