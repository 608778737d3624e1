// @ts-check
/** Says when the live connection is gone, and when it is back; nothing while all is well. */
import { h, show } from "../dom.js";
import { store } from "../store.js";

/** How long "connected again" stays. [ms] */
const FAREWELL = 4000;

export class Connection extends HTMLElement {
  #ended = new AbortController();
  #lost = false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  connectedCallback() {
    this.setAttribute("role", "status");
    store.watch("connected", (connected) => this.#show(connected), this.#ended.signal);
  }

  disconnectedCallback() {
    this.#ended.abort();
    clearTimeout(this.#timer);
  }

  /** @param {boolean} connected */
  #show(connected) {
    clearTimeout(this.#timer);
    if (!connected) {
      show(
        this,
        h("div", { class: "banner" }, h("strong", null, "No connection to the server."), " What you see is as it was; jobs go on. This page resumes by itself."),
      );
    } else if (this.#lost) {
      show(this, h("div", { class: "banner well" }, "Connected again."));
      this.#timer = setTimeout(() => show(this), FAREWELL);
    } else show(this);
    this.#lost = !connected;
  }
}

customElements.define("tb-connection", Connection);
