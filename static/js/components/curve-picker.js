// @ts-check
/**
 * Which channels a chart draws: chips of those drawn, and a list of all others to tick, by group and
 * by words. Emits `curves` [names].
 */
import { MOST, fitting, found, groupText, groupsOf, placeOf } from "../channel-choice.js";
import { h, show } from "../dom.js";

/** @typedef {import("../types.js").Channel} Channel */

/** More rows than this nobody reads; words narrow them down. */
const ROWS = 200;

export class CurvePicker extends HTMLElement {
  /** @type {(() => Promise<Channel[]>) | null} */
  #load = null;
  #any = false;
  /** @type {Channel[] | null} */
  #all = null;
  /** @type {string[]} */
  #drawn = [];
  #group = "";
  #chips = h("div", { class: "row curves" });
  #search = h("input", { type: "search", "aria-label": "Search the curves", placeholder: "Search, e.g. wheel 03", oninput: () => this.#list() });
  #groups = h("div", { class: "row", role: "group", "aria-label": "Kind of curve" });
  #rows = h("ul", { class: "channel-rows", "aria-label": "Curves", tabindex: 0 });
  #said = h("p", { class: "soft small", role: "status" });

  /**
   * @param {{ load: () => Promise<Channel[]>, any: boolean, drawn: string[] }} options `any`: curves
   *   of whatever quantity
   */
  bind({ load, any, drawn }) {
    this.#load = load;
    this.#any = any;
    this.#drawn = drawn;
  }

  /** Names of the channels that are drawn. @param {string[]} drawn */
  set drawn(drawn) {
    this.#drawn = drawn;
    if (this.#all) this.#draw();
  }

  /** Fetches the run's channels when they are first wanted. */
  async load() {
    if (this.#all || !this.#load) return;
    try {
      this.#all = await this.#load();
      show(
        this,
        this.#chips,
        h(
          "details",
          { class: "all-curves" },
          h("summary", null, "All curves"),
          h("div", { class: "row" }, this.#search, this.#groups),
          this.#rows,
          this.#said,
        ),
      );
      this.#draw();
    } catch (error) {
      show(this, h("p", { class: "small soft" }, /** @type {Error} */ (error).message));
    }
  }

  #draw() {
    const title = (/** @type {string} */ name) => (this.#any ? name : placeOf(name));
    show(
      this.#chips,
      this.#drawn.map((name) =>
        h(
          "button",
          {
            type: "button",
            class: "chip",
            disabled: this.#drawn.length === 1,
            "aria-label": `Remove ${title(name)}`,
            onclick: () => this.#tell(this.#drawn.filter((other) => other !== name)),
          },
          title(name),
          h("span", { "aria-hidden": "true" }, "×"),
        ),
      ),
    );
    const groups = groupsOf(this.#offered());
    this.#groups.hidden = groups.length < 2;
    show(this.#groups, ["", ...groups].map((group) => this.#groupButton(group)));
    this.#list();
  }

  /** @returns {Channel[]} */
  #offered() {
    return fitting(this.#all ?? [], { drawn: this.#drawn, any: this.#any });
  }

  /** @param {string} group */
  #groupButton(group) {
    const choose = () => {
      this.#group = group;
      for (const other of this.#groups.children) other.setAttribute("aria-pressed", String(other === button));
      this.#list();
    };
    const button = h("button", { type: "button", class: "chip", "aria-pressed": String(group === this.#group), onclick: choose }, group ? groupText(group) : "All");
    return button;
  }

  #list() {
    const hits = found(this.#offered(), { text: this.#search.value, group: this.#group });
    const focused = /** @type {HTMLInputElement | null} */ (document.activeElement)?.value;
    const within = this.#rows.contains(document.activeElement);
    show(this.#rows, hits.slice(0, ROWS).map((channel) => h("li", null, this.#row(channel))));
    const full = this.#drawn.length >= MOST ? ` A chart holds at most ${MOST}.` : "";
    const cut = hits.length > ROWS ? `, the first ${ROWS} shown` : "";
    show(this.#said, `${hits.length} curve${hits.length === 1 ? "" : "s"}${cut}.${full}`);
    if (within) /** @type {HTMLElement | null} */ (this.#rows.querySelector(`[value="${CSS.escape(focused ?? "")}"]`))?.focus();
  }

  /** @param {Channel} channel */
  #row({ name }) {
    const drawn = this.#drawn.includes(name);
    const box = h("input", {
      type: "checkbox",
      value: name,
      checked: drawn,
      disabled: drawn ? this.#drawn.length === 1 : this.#drawn.length >= MOST,
      onchange: () => this.#tell(drawn ? this.#drawn.filter((other) => other !== name) : [...this.#drawn, name]),
    });
    return h("label", null, box, this.#any ? name : placeOf(name));
  }

  /** @param {string[]} channels */
  #tell(channels) {
    this.dispatchEvent(new CustomEvent("curves", { detail: channels }));
  }
}

customElements.define("tb-curve-picker", CurvePicker);
