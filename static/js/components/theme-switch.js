// @ts-check
/** Chooses light, dark or the system's theme: a button, and three radio buttons in its menu. */
import { h, s, show } from "../dom.js";
import { store } from "../store.js";
import { CHOICES, chooseTheme } from "../theme.js";

/** @typedef {import("../theme.js").ThemeChoice} ThemeChoice */

/** @type {Record<ThemeChoice, string>} */
const WORDS = { light: "Light", dark: "Dark", system: "As the system" };
/** @type {Record<ThemeChoice, string>} paths in a square of 24 */
const DRAWN = {
  light: "M12 7.5a4.5 4.5 0 1 0 0 9 4.5 4.5 0 0 0 0-9zM12 1.8v2.7M12 19.5v2.7M1.8 12h2.7M19.5 12h2.7M4.8 4.8l1.9 1.9M17.3 17.3l1.9 1.9M4.8 19.2l1.9-1.9M17.3 6.7l1.9-1.9",
  dark: "M20 14.2A8.4 8.4 0 0 1 9.8 4 8.4 8.4 0 1 0 20 14.2z",
  system: "M3 4.5h18v12H3zM8.5 20.5h7M12 16.5v4",
};

export class ThemeSwitch extends HTMLElement {
  #ended = new AbortController();
  #button = h("button", { type: "button", class: "quiet icon", popovertarget: "theme-menu" });
  #menu = h("fieldset", { id: "theme-menu", class: "menu theme-menu", popover: "auto" }, h("legend", { class: "sr" }, "Theme"));

  connectedCallback() {
    this.#menu.append(...CHOICES.map((choice) => this.#choice(choice)));
    show(this, this.#button, this.#menu);
    store.watch("themeChoice", (choice) => this.#show(choice), this.#ended.signal);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** @param {ThemeChoice} choice */
  #choice(choice) {
    const radio = h("input", { type: "radio", name: "theme", value: choice, onchange: () => chooseTheme(choice) });
    return h("label", { class: "menu-item" }, radio, drawn(choice), WORDS[choice]);
  }

  /** @param {ThemeChoice} choice */
  #show(choice) {
    this.#button.setAttribute("aria-label", `Theme: ${WORDS[choice].toLowerCase()}`);
    this.#button.title = `Theme: ${WORDS[choice].toLowerCase()}`;
    show(this.#button, drawn(choice));
    for (const radio of this.#menu.querySelectorAll("input")) radio.checked = radio.value === choice;
  }
}

/** @param {ThemeChoice} choice */
function drawn(choice) {
  return s("svg", { viewBox: "0 0 24 24", width: 20, height: 20, class: "glyph", "aria-hidden": "true" }, s("path", { d: DRAWN[choice] }));
}

customElements.define("tb-theme", ThemeSwitch);
