// @ts-check
/** Runs that are done, to be put beside others; found by the name of their job. Emits `join` {run}. */
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { ago, speed } from "../format.js";
import { subject } from "../job-words.js";

/** @typedef {import("../types.js").Job} Job */

/** Typing pauses this long before the server is asked. [ms] */
const PAUSE = 250;

export class ComparePicker extends HTMLElement {
  #name = h("input", { type: "text", id: "compare-find", placeholder: "Name of a job", autocomplete: "off", oninput: () => this.#typed() });
  #list = h("ul", { class: "compare-found" });
  #said = h("p", { class: "soft small", role: "status" });
  /** @type {string[]} */
  #chosen = [];
  /** @type {Job[]} */
  #jobs = [];
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #asked = false;

  connectedCallback() {
    show(this, h("div", { class: "compare-find" }, h("label", { for: "compare-find" }, "Find"), this.#name), this.#list, this.#said);
  }

  disconnectedCallback() {
    clearTimeout(this.#timer);
  }

  /** Runs that stand side by side already. @param {string[]} runs */
  set chosen(runs) {
    this.#chosen = runs;
    this.#draw();
  }

  /** Asks the server, once until somebody types. */
  async load() {
    if (this.#asked) return;
    this.#asked = true;
    await this.#find();
  }

  #typed() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#find(), PAUSE);
  }

  async #find() {
    const name = this.#name.value;
    try {
      const { items } = await api.findJobs({ states: ["done", "running", "failed", "cancelled"], name: name.trim() });
      if (name !== this.#name.value) return; // somebody typed on: the answer to that is on its way
      this.#jobs = items;
      this.#draw();
    } catch (error) {
      show(this.#said, /** @type {Error} */ (error).message);
    }
  }

  #draw() {
    const found = this.#jobs.flatMap((job) => job.runs.filter((run) => run.state === "done").map((run) => ({ job, run })));
    const free = found.filter(({ run }) => !this.#chosen.includes(run.id));
    show(this.#list, free.map(({ job, run }) => this.#item(job, run)));
    show(this.#said, this.#asked && !free.length ? (found.length ? "Every run that was found stands side by side already." : "No run that is done was found.") : null);
  }

  /**
   * @param {Job} job
   * @param {import("../types.js").RunItem} run
   */
  #item(job, run) {
    const moving = Number.isFinite(run.parameters.speed) ? speed(run.parameters.speed) : subject(job);
    return h(
      "li",
      null,
      h("button", { type: "button", onclick: () => this.dispatchEvent(new CustomEvent("join", { detail: { run: run.id }, bubbles: true })) }, "Add"),
      h("span", null, `${job.name}, ${moving}`),
      h("span", { class: "soft small" }, ago(job.created, Date.now())),
    );
  }
}

customElements.define("tb-compare-picker", ComparePicker);
