// @ts-check
/** Every job of this server, newest first: filtered by state and name, compared, deleted. */
import { confirmed } from "../components/confirm.js";
import { JobList } from "../components/job-list.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { STATE_CHOICES, matches, statesOf } from "../job-filter.js";
import { remember } from "../router.js";
import { store } from "../store.js";

/** @typedef {import("../router.js").Route} Route */

/** Typing pauses this long before the server is asked. [ms] */
const PAUSE = 250;
/** As many runs as the server compares. */
const MOST = 12;

export class JobsPage extends HTMLElement {
  /** @type {Route} */
  route = { name: "jobs", parts: [], query: new URLSearchParams() };
  #ended = new AbortController();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #asked = 0;
  /** Whether the jobs could not be asked for. */
  #missed = false;
  #notice = h("div", { role: "alert" });
  #list = /** @type {JobList} */ (h("tb-job-list"));
  #search = h("input", { type: "search", "aria-label": "Search by name", placeholder: "Search by name", oninput: () => this.#later() });
  #state = h("select", { "aria-label": "State", onchange: () => void this.#filter() });
  #compare = h("a", { class: "button primary", hidden: true }, "Compare");
  #remove = h("button", { type: "button", class: "danger", hidden: true, onclick: () => void this.#delete() }, "Delete…");
  #said = h("p", { class: "soft small", role: "status" });

  connectedCallback() {
    document.title = "Jobs · Trainbridge";
    const { query } = this.route;
    this.#search.value = query.get("name") ?? "";
    show(this.#state, STATE_CHOICES.map(({ name, title }) => h("option", { value: name, selected: name === query.get("state") }, title)));
    this.#list.tickable = true;
    show(
      this,
      h("h1", null, "Jobs"),
      h("div", { class: "row jobs-bar" }, this.#search, this.#state, h("span", { class: "row ticked" }, this.#said, this.#compare, this.#remove)),
      this.#notice,
      this.#list,
    );
    this.#list.addEventListener("more", (event) => void this.#more(/** @type {CustomEvent} */ (event).detail.cursor));
    this.#list.addEventListener("tick", () => this.#count());
    void this.#begin();
  }

  disconnectedCallback() {
    clearTimeout(this.#timer);
    this.#ended.abort();
  }

  async #begin() {
    this.#count();
    await this.#filter();
    if (!this.isConnected) return;
    const signal = this.#ended.signal;
    store.watch("job", (job) => this.#hear(job), signal);
    store.watch("connected", (connected) => connected && this.#missed && void this.#filter(), signal);
  }

  /** A job that has changed may no longer be what was asked for. @param {import("../types.js").Job} job */
  #hear(job) {
    if (matches(job, this.#wanted)) this.#list.update(job);
    else if (this.#list.jobs.some(({ id }) => id === job.id)) this.#list.drop(job.id);
  }

  get #wanted() {
    return { state: this.#state.value, name: this.#search.value.trim() };
  }

  #later() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#filter(), PAUSE);
  }

  async #filter() {
    const { state, name } = this.#wanted;
    remember("state", state || null);
    remember("name", name || null);
    this.#asked += 1;
    const asked = this.#asked;
    if (state || name) this.#list.empty = ["No job is like that.", "Other words or another state may find it."];
    try {
      const page = await api.findJobs({ states: statesOf(state), name });
      if (asked !== this.#asked) return;
      this.#list.page = page;
      this.#missed = false;
      show(this.#notice);
    } catch (error) {
      if (asked !== this.#asked) return;
      this.#missed = true;
      this.#complain(error);
    }
  }

  /** @param {string} cursor */
  async #more(cursor) {
    const { state, name } = this.#wanted;
    const asked = this.#asked;
    try {
      const page = await api.findJobs({ states: statesOf(state), name, cursor });
      if (asked !== this.#asked) return; // of another filter
      this.#list.add(page);
      show(this.#notice);
    } catch (error) {
      if (asked !== this.#asked) return;
      this.#list.add({ items: [], next: cursor }); // the button works again
      this.#complain(error);
    }
  }

  /** What can be done with what is ticked. */
  #count() {
    const { jobs, runs } = this.#list.ticked;
    const enough = runs.length > 1 && runs.length <= MOST;
    this.#compare.hidden = !enough;
    this.#compare.href = `#/compare?${new URLSearchParams({ runs: runs.join(",") })}`;
    this.#remove.hidden = jobs.length === 0;
    show(this.#compare, `Compare ${runs.length} runs`);
    show(this.#remove, `Delete ${jobs.length}…`);
    if (runs.length > MOST) show(this.#said, `${runs.length} runs: at most ${MOST} can be compared.`);
    else show(this.#said, runs.length === 1 ? "Tick another run to compare." : "");
  }

  async #delete() {
    const { jobs } = this.#list.ticked;
    const many = jobs.length > 1 ? `${jobs.length} jobs` : "this job";
    if (!(await confirmed({ question: `Delete ${many}?`, words: "Results, histories and pictures go with them. What still computes is cancelled first.", action: "Delete" }))) return;
    this.#remove.disabled = true;
    try {
      for (const job of jobs) {
        await api.removeJob(job);
        this.#list.drop(job);
      }
    } catch (error) {
      this.#complain(error);
    }
    this.#remove.disabled = false;
  }

  /** @param {unknown} error */
  #complain(error) {
    show(this.#notice, h("div", { class: "notice bad" }, h("p", null, /** @type {Error} */ (error).message)));
  }
}

customElements.define("tb-jobs-page", JobsPage);
