// @ts-check
/** Every job of this server, newest first. */
import { JobList } from "../components/job-list.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { store } from "../store.js";

export class JobsPage extends HTMLElement {
  #ended = new AbortController();
  #notice = h("div", { role: "alert" });
  #list = /** @type {JobList} */ (h("tb-job-list"));

  async connectedCallback() {
    document.title = "Jobs · Trainbridge";
    show(this, h("h1", null, "Jobs"), this.#notice, this.#list);
    this.addEventListener("more", (event) => void this.#more(/** @type {CustomEvent} */ (event).detail.cursor));
    try {
      this.#list.page = await api.jobs();
      store.watch("job", (job) => this.#list.update(job), this.#ended.signal);
    } catch (error) {
      this.#complain(error);
    }
  }

  disconnectedCallback() {
    this.#ended.abort();
  }

  /** @param {string} cursor */
  async #more(cursor) {
    try {
      this.#list.add(await api.jobs(cursor));
      show(this.#notice);
    } catch (error) {
      this.#list.add({ items: [], next: cursor }); // the button works again
      this.#complain(error);
    }
  }

  /** @param {unknown} error */
  #complain(error) {
    show(this.#notice, h("div", { class: "notice bad" }, h("p", null, /** @type {Error} */ (error).message)));
  }
}

customElements.define("tb-jobs-page", JobsPage);
