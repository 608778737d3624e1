// @ts-check
/** A job's name, what it computes, its state; emits `choose` {run} and `cancel`. */
import { h, show } from "../dom.js";
import { ago, speed, stateText } from "../format.js";
import { subject } from "../job-words.js";

/** @typedef {import("../types.js").Job} Job */

export class JobHead extends HTMLElement {
  /** @type {HTMLButtonElement | null} */
  #cancel = null;

  /**
   * @param {Job} job
   * @param {string} chosen id of the run that is shown
   */
  bind(job, chosen) {
    const active = job.state === "queued" || job.state === "running";
    this.#cancel = active ? h("button", { type: "button", class: "danger", onclick: () => this.#emit("cancel") }, "Cancel") : null;
    show(
      this,
      h(
        "div",
        { class: "row spread" },
        h(
          "div",
          null,
          h("h1", null, job.name || job.kind),
          h("p", { class: "soft" }, `${subject(job)} · submitted ${ago(job.created, Date.now())}`),
        ),
        h(
          "div",
          { class: "row" },
          job.runs.length > 1 && this.#picker(job, chosen),
          h("span", { class: `tag ${job.state}` }, stateText(job.state)),
          this.#cancel,
        ),
      ),
    );
  }

  /** Whether the cancellation is on its way. @param {boolean} cancelling */
  set cancelling(cancelling) {
    if (!this.#cancel) return;
    this.#cancel.disabled = cancelling;
    show(this.#cancel, cancelling ? "Cancelling…" : "Cancel");
  }

  /**
   * Which run is shown.
   *
   * @param {Job} job
   * @param {string} chosen
   */
  #picker(job, chosen) {
    const select = h(
      "select",
      { "aria-label": "Run", onchange: () => this.#emit("choose", { run: select.value }) },
      job.runs.map((run) => h("option", { value: run.id, selected: run.id === chosen }, speed(run.parameters.speed))),
    );
    return select;
  }

  /**
   * @param {string} name
   * @param {any} [detail]
   */
  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail, bubbles: true }));
  }
}

customElements.define("tb-job-head", JobHead);
