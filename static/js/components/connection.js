// @ts-check
/** Says when the live connection is gone; says nothing while all is well. */
import { h, show } from "../dom.js";
import { store } from "../store.js";

export class Connection extends HTMLElement {
  #ended = new AbortController();

  connectedCallback() {
    this.setAttribute("role", "status");
    store.watch("connected", (connected) => this.#show(connected), this.#ended.signal);
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** @param {boolean} connected */
  #show(connected) {
    show(
      this,
      connected === false &&
        h(
          "div",
          { class: "banner" },
          "No connection to the server. Jobs go on; this page resumes by itself.",
        ),
    );
  }
}

customElements.define("tb-connection", Connection);
