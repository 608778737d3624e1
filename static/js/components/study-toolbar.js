// @ts-check
/** Above the form: form or JSON, undo and redo, what changed, the way to each section. */
import { h, s, show } from "../dom.js";
import { segments } from "./segments.js";

/** @typedef {{ canUndo: boolean, canRedo: boolean, changes: number, called: string }} Standing */
/** @typedef {{ undo: () => void, redo: () => void, restart: () => void, copy: () => void, view: (name: string) => void }} Deeds */

/** How a study or a part of one can be edited: value and words. @type {[string, string][]} */
export const VIEWS = [["form", "Form"], ["json", "JSON"]]; // prettier-ignore
const UNDO = "M4 5.5H10a3.6 3.6 0 0 1 0 7.2H6M6.6 2.6L3.6 5.5l3 2.9";

export class StudyToolbar extends HTMLElement {
  #undo = icon("Undo", "Ctrl+Z", UNDO, false);
  #redo = icon("Redo", "Ctrl+Shift+Z", UNDO, true);
  #restart = h("button", { type: "button", class: "link small" });
  #changes = h("span", { class: "soft small", role: "status" });
  #sections = h("nav", { class: "section-links", "aria-label": "Sections of the study" });

  /** @param {Deeds} deeds */
  bind(deeds) {
    this.#undo.addEventListener("click", deeds.undo);
    this.#redo.addEventListener("click", deeds.redo);
    this.#restart.addEventListener("click", deeds.restart);
    show(
      this,
      h("div", { class: "tools" },
        segments({ legend: "Edit as", options: VIEWS, chosen: "form", choose: deeds.view }),
        h("div", { class: "row tight" }, this.#undo, this.#redo),
        this.#changes,
        this.#restart,
        h("button", { type: "button", class: "end", onclick: deeds.copy }, "Copy as…")),
      this.#sections,
    ); // prettier-ignore
  }

  /** What is shown, "form" or "json". @param {string} name */
  set view(name) {
    for (const input of /** @type {NodeListOf<HTMLInputElement>} */ (this.querySelectorAll(".segments input"))) input.checked = input.value === name;
    this.classList.toggle("json", name === "json");
  }

  /** @param {Standing} standing */
  update({ canUndo, canRedo, changes, called }) {
    this.#undo.disabled = !canUndo;
    this.#redo.disabled = !canRedo;
    this.#restart.hidden = changes === 0;
    show(this.#restart, `Back to ${called}`);
    show(this.#changes, changes ? [h("span", { class: "dot", "aria-hidden": "true" }), `${changes} changed`] : `As ${called}`);
  }

  /**
   * Links to the sections that are drawn, with those that have something to mend marked.
   *
   * @param {HTMLElement[]} sections
   */
  set sections(sections) {
    show(
      this.#sections,
      sections.map((section) => {
        const invalid = section.querySelector(".invalid") !== null;
        return h(
          "button",
          { type: "button", class: invalid ? "section-link bad" : "section-link", onclick: () => reach(section) },
          section.querySelector("h2")?.textContent ?? "",
          section.querySelector(".changed") && h("span", { class: "dot" }, h("span", { class: "sr" }, ", changed")),
          invalid && h("span", { class: "flag" }, "!", h("span", { class: "sr" }, " to mend")),
        );
      }),
    );
  }
}

/** @param {HTMLElement} section */
function reach(section) {
  section.scrollIntoView({ block: "start" });
  section.focus({ preventScroll: true });
}

/**
 * @param {string} name
 * @param {string} keys
 * @param {string} path
 * @param {boolean} mirrored
 */
function icon(name, keys, path, mirrored) {
  return h(
    "button",
    { type: "button", class: "icon", "aria-label": name, title: `${name} (${keys})`, "aria-keyshortcuts": keys.replace("Ctrl", "Control") },
    s("svg", { viewBox: "0 0 16 16", width: 18, height: 18, "aria-hidden": "true" }, s("path", { d: path, class: "glyph", transform: mirrored ? "matrix(-1 0 0 1 16 0)" : null })),
  );
}

customElements.define("tb-study-toolbar", StudyToolbar);
