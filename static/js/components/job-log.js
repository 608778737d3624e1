// @ts-check
/** What happened to a job, line by line; follows while it runs. */
import { api, logUrl } from "../api.js";
import { h, show } from "../dom.js";
import { logLines } from "../job-words.js";

/** While the job runs, the log is read again this often. [ms] */
const PACE = 2500;

export class JobLog extends HTMLElement {
  #job = "";
  #active = false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #text = "";
  #lines = h("ol", { class: "log mono" });
  #box = h("div", { class: "log-box", tabindex: 0, role: "log", "aria-label": "Log of the job" }, this.#lines);
  #note = h("p", { class: "soft small", role: "status" });

  /** @param {string} job */
  bind(job) {
    this.#job = job;
    this.classList.add("card", "sheet");
    show(
      this,
      h("div", { class: "row spread" }, h("h2", null, "Log"), h("a", { class: "button quiet", href: logUrl(job), download: "" }, "Save")),
      this.#box,
      this.#note,
    );
  }

  connectedCallback() {
    void this.#read();
  }

  disconnectedCallback() {
    clearTimeout(this.#timer);
  }

  /** Whether the job still runs: then the log is followed. @param {boolean} active */
  set active(active) {
    if (active === this.#active) return;
    this.#active = active;
    void this.#read();
  }

  async #read() {
    clearTimeout(this.#timer);
    if (!this.isConnected) return;
    try {
      const text = await api.jobLog(this.#job);
      if (text !== this.#text) this.#draw(text);
      show(this.#note, this.#active ? "Follows the computation." : "");
    } catch (error) {
      show(this.#note, /** @type {Error} */ (error).message);
    }
    clearTimeout(this.#timer);
    if (this.#active && this.isConnected) this.#timer = setTimeout(() => void this.#read(), PACE);
  }

  /** @param {string} text */
  #draw(text) {
    const box = this.#box;
    const atEnd = box.scrollHeight - box.scrollTop - box.clientHeight < 40;
    this.#text = text;
    show(
      this.#lines,
      logLines(text).map(({ time, run, words }) =>
        h("li", null, h("time", { datetime: time }, clock(time)), h("span", { class: "log-run" }, run), h("span", null, words)),
      ),
    );
    if (atEnd) box.scrollTop = box.scrollHeight;
  }
}

/** @param {string} time ISO 8601 */
const clock = (time) => new Date(time).toLocaleTimeString([], { timeStyle: "medium" });

customElements.define("tb-job-log", JobLog);
