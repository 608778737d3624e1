// @ts-check
/** Elevation and cross-section of a study, one above the other, and what their marks mean. */
import { h, s, show } from "../dom.js";
import { stretchOf } from "../irregularity-profile.js";
import { layoutOf } from "../layout.js";
import { CrossSection } from "./cross-section.js";
import { Elevation } from "./elevation.js";
import { LibraryProfile } from "./library-profile.js";

/** @typedef {import("../types.js").Study} Study */

export class StudyDrawing extends HTMLElement {
  #elevation = /** @type {Elevation} */ (h("tb-elevation"));
  #section = /** @type {CrossSection} */ (h("tb-cross-section"));
  #profile = /** @type {LibraryProfile} */ (h("tb-library-profile", { hidden: true }));
  #legend = h("ul", { class: "legend" });

  connectedCallback() {
    this.#elevation.labelled = true;
    show(this, this.#elevation, this.#section, this.#legend, this.#profile);
  }

  /**
   * @param {Study} study
   * @param {string} kind of the job: modes are drawn without the load that they have not
   */
  draw(study, kind) {
    const scope = kind === "modes" ? (study.modes?.part ?? "viaduct") : "crossing";
    this.#elevation.scope = scope;
    this.#elevation.study = study;
    this.#section.loaded = scope === "crossing";
    this.#section.study = study;
    this.#section.hidden = scope === "track" || scope === "train"; // these have no deck
    const marked = scope === "crossing";
    const judged = marked && layoutOf(study).points.some((point) => point.judged);
    const defect = marked && Number.isFinite(study.irregularity?.position);
    const measured = marked && stretchOf(study.irregularity) !== null;
    this.#profile.hidden = !measured;
    if (measured) this.#profile.irregularity = study.irregularity;
    show(
      this.#legend,
      judged && h("li", null, mark(s("circle", { class: "point judged", cx: 6, cy: 6, r: 4 })), "judged"),
      marked && h("li", null, mark(s("circle", { class: "point", cx: 6, cy: 6, r: 4 })), "output point"),
      defect && h("li", null, mark(s("path", { class: "flaw", d: "M1 11h10L6 2Z" })), "defect, not to scale"),
      measured && h("li", null, mark(s("path", { class: "measured", d: "M0 7q2-6 4-1t4 1t4-3" })), "measured profile, not to scale"),
    );
  }
}

/** @param {Element} shape */
function mark(shape) {
  return s("svg", { viewBox: "0 0 12 12", width: 12, height: 12, class: "elevation-mark", "aria-hidden": "true" }, shape);
}

customElements.define("tb-study-drawing", StudyDrawing);
