// @ts-check
/** Chooses a point of the deck by its coordinates, as a press on the map or in the 3D view does. */
import { h, show } from "../dom.js";

/** @typedef {import("../run-view.js").RunView} RunView */

export class PlaceForm extends HTMLElement {
  /** @type {RunView | null} */
  #view = null;
  #ended = new AbortController();
  #x = field();
  #y = field();

  /** @param {RunView} view what is looked at */
  set view(view) {
    this.#view = view;
    this.classList.add("card", "place-form");
    show(
      this,
      h(
        "form",
        { class: "row", "aria-label": "A point of the deck", onsubmit: (/** @type {Event} */ event) => this.#choose(event) },
        h("span", { class: "soft" }, "Histories of a point of the deck:"),
        h("label", { class: "inline" }, "x [m]", this.#x),
        h("label", { class: "inline" }, "y [m]", this.#y),
        h("button", { type: "submit" }, "Show"),
      ),
    );
    view.watch(["place"], () => this.#fill(), this.#ended.signal);
    this.#fill();
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  #fill() {
    const place = this.#view?.look.place;
    if (!place) return;
    this.#x.value = String(Number(place[0].toFixed(3)));
    this.#y.value = String(Number(place[1].toFixed(3)));
  }

  /** @param {Event} event */
  #choose(event) {
    event.preventDefault();
    const view = this.#view;
    view?.set({ place: [this.#x.valueAsNumber, this.#y.valueAsNumber, view.slabLevel] });
  }
}

const field = () => h("input", { type: "number", step: "any", required: true, inputmode: "decimal" });

customElements.define("tb-place-form", PlaceForm);
