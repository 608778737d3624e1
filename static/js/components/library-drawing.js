// @ts-check
/** A part of the library, drawn: what of it depends on its kind. */
import { h, show } from "../dom.js";
import { studyAround } from "../library-parts.js";
import { CrossSection } from "./cross-section.js";
import { Elevation } from "./elevation.js";
import { LibraryProfile } from "./library-profile.js";
import { LibraryTrack } from "./library-track.js";
import { LibraryTrain } from "./library-train.js";

/** @typedef {import("../types.js").Template} Template */

export class LibraryDrawing extends HTMLElement {
  /**
   * @param {string} kind
   * @param {any} value
   * @param {Template[]} templates
   */
  bind(kind, value, templates) {
    this.classList.add("library-drawing");
    show(this, pictures(kind, value, templates));
  }
}

/**
 * @param {string} kind
 * @param {any} value
 * @param {Template[]} templates
 * @returns {HTMLElement[]}
 */
function pictures(kind, value, templates) {
  if (kind === "trains") return [made("tb-library-train", LibraryTrain, { train: value })];
  if (kind === "viaducts") {
    const study = studyAround("viaduct", value, templates);
    return [made("tb-elevation", Elevation, { labelled: true, study }), made("tb-cross-section", CrossSection, { study })];
  }
  if (kind === "tracks") {
    const side = made("tb-library-track", LibraryTrack, { track: value });
    const study = studyAround("track", value, templates);
    return value?.type === "ballasted" ? [side, made("tb-cross-section", CrossSection, { study })] : [side];
  }
  return [made("tb-library-profile", LibraryProfile, { irregularity: value })];
}

/**
 * An element with its properties set in their order.
 *
 * @template {HTMLElement} E
 * @param {string} tag
 * @param {new () => E} _kind
 * @param {Partial<E>} properties
 * @returns {E}
 */
function made(tag, _kind, properties) {
  return Object.assign(/** @type {any} */ (h(tag)), properties);
}

customElements.define("tb-library-drawing", LibraryDrawing);
