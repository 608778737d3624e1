// @ts-check
/** Every job of this server, newest first. */
import { JobList } from "../components/job-list.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { store } from "../store.js";

export class JobsPage extends HTMLElement {
  #ended = new AbortController();

  async connectedCallback() {
    document.title = "Jobs · Trainbridge";
    const list = /** @type {JobList} */ (h("tb-job-list"));
    show(this, h("h1", null, "Jobs"), list);
    try {
      list.jobs = (await api.jobs()).items;
      store.watch("job", (job) => list.update(job), this.#ended.signal);
    } catch (error) {
      show(this, h("div", { class: "notice bad", role: "alert" }, h("p", null, /** @type {Error} */ (error).message)));
    }
  }

  disconnectedCallback() {
    this.#ended.abort();
  }
}

customElements.define("tb-jobs-page", JobsPage);
