// @ts-check
/** A line over the 3D view that says why it shows nothing, or no longer moves, with a way out. */
import { h, show } from "../dom.js";

export class ViewerMessage extends HTMLElement {
  #words = "";

  connectedCallback() {
    this.setAttribute("role", "status");
    this.hidden = this.#words === "";
  }

  /**
   * @param {string} words none takes the message away
   * @param {string} [action]
   * @param {() => void} [act]
   */
  say(words, action, act) {
    if (this.#words === words) return;
    this.#words = words;
    this.hidden = !words;
    show(this, h("p", null, words), action && h("button", { type: "button", onclick: act }, action));
  }
}

customElements.define("tb-viewer-message", ViewerMessage);
