// @ts-check
/** Which channels a chart draws: add one of the same quantity, take one away. Emits `curves`. */
import { api } from "../api.js";
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").Channel} Channel */

/** As many curves as one figure may hold. */
const MOST = 16;

export class CurvePicker extends HTMLElement {
  /** @type {Channel[] | null} */
  #all = null;
  #run = "";
  /** @type {string[]} */
  #drawn = [];

  /**
   * @param {string} run
   * @param {string[]} drawn names of the channels that are drawn
   */
  bind(run, drawn) {
    this.#run = run;
    this.#drawn = drawn;
    if (this.#all) this.#draw();
  }

  /** Fetches the run's channels when they are first wanted. */
  async load() {
    if (this.#all) return;
    try {
      const answer = await api.channels(this.#run);
      this.#all = answer.items ?? answer;
      this.#draw();
    } catch (error) {
      show(this, h("p", { class: "small soft" }, /** @type {Error} */ (error).message));
    }
  }

  #draw() {
    const quantity = quantityOf(this.#drawn[0] ?? "");
    const others = (this.#all ?? []).filter(
      (channel) => quantityOf(channel.name) === quantity && !this.#drawn.includes(channel.name),
    );
    const add = h(
      "select",
      { "aria-label": "Add a curve", onchange: () => this.#tell([...this.#drawn, add.value]) },
      h("option", { value: "" }, "Add a curve…"),
      others.map((channel) => h("option", { value: channel.name }, placeOf(channel.name))),
    );
    add.disabled = others.length === 0 || this.#drawn.length >= MOST;
    show(
      this,
      h(
        "div",
        { class: "row curves" },
        this.#drawn.map((name) =>
          h(
            "button",
            {
              type: "button",
              class: "chip",
              disabled: this.#drawn.length === 1,
              "aria-label": `Remove ${placeOf(name)}`,
              onclick: () => this.#tell(this.#drawn.filter((other) => other !== name)),
            },
            placeOf(name),
            h("span", { "aria-hidden": "true" }, "×"),
          ),
        ),
        add,
      ),
    );
  }

  /** @param {string[]} channels */
  #tell(channels) {
    this.dispatchEvent(new CustomEvent("curves", { detail: channels, bubbles: true }));
  }
}

/** @param {string} name */
const quantityOf = (name) => name.slice(name.lastIndexOf("/") + 1);

/** @param {string} name */
const placeOf = (name) => name.slice(0, Math.max(name.lastIndexOf("/"), 0)) || name;

customElements.define("tb-curve-picker", CurvePicker);
