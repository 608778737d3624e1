// @ts-check
/**
 * A job's name, what it computes, its state, and what can be done with it. Emits `choose` {run} and
 * `act` {action}: cancel, retry, clone, delete.
 */
import { h, show } from "../dom.js";
import { ago, speed, stateText } from "../format.js";
import { subject } from "../job-words.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {"cancel" | "retry" | "clone" | "delete"} Action */

export class JobHead extends HTMLElement {
  /** @type {HTMLButtonElement[]} */
  #buttons = [];

  /**
   * @param {Job} job
   * @param {string} chosen id of the run that is shown
   */
  bind(job, chosen) {
    this.#buttons = [];
    const focused = /** @type {HTMLElement | null} */ (this.contains(document.activeElement) ? document.activeElement : null);
    const kept = focused?.dataset.action ?? focused?.getAttribute("aria-label");
    show(
      this,
      h(
        "div",
        { class: "row spread" },
        h(
          "div",
          null,
          h("h1", null, job.name || job.kind),
          h(
            "p",
            { class: "soft" },
            `${subject(job)} · submitted ${ago(job.created, Date.now())}`,
            job.source && [" · again from ", h("a", { href: link("jobs", job.source) }, "an earlier job")],
          ),
        ),
        h("div", { class: "row job-tools" }, job.runs.length > 1 && this.#picker(job, chosen), h("span", { class: `tag ${job.state}` }, stateText(job.state)), this.#actions(job)),
      ),
    );
    if (kept) /** @type {HTMLElement | null} */ (this.querySelector(`[data-action="${kept}"], [aria-label="${kept}"]`))?.focus();
  }

  /** Whether something that was asked for is on its way. @param {boolean} busy */
  set busy(busy) {
    for (const button of this.#buttons) button.disabled = busy;
  }

  /** @param {Job} job */
  #actions(job) {
    const active = job.state === "queued" || job.state === "running";
    const remove = this.#button("delete", "Delete…", "quiet danger");
    if (active) return [this.#button("cancel", "Cancel", "danger"), this.#menu([edit(job), remove])];
    const again = this.#button("clone", "Run again", "quiet");
    if (job.state === "done") return [h("a", { class: "button", href: link("report", job.id) }, "Report"), edit(job), this.#menu([again, remove])];
    return [this.#button("retry", "Retry", "primary"), edit(job), this.#menu([again, remove])];
  }

  /** @param {HTMLElement[]} items */
  #menu(items) {
    const menu = h("details", { class: "drop end" }, h("summary", { class: "button icon", "aria-label": "More" }, "⋯"), h("div", { class: "card drop-sheet" }, items));
    menu.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      menu.open = false;
      menu.querySelector("summary")?.focus();
    });
    menu.addEventListener("focusout", ({ relatedTarget }) => {
      if (relatedTarget && !menu.contains(/** @type {Node} */ (relatedTarget))) menu.open = false;
    });
    return menu;
  }

  /**
   * @param {Action} action
   * @param {string} words
   * @param {string} look
   */
  #button(action, words, look) {
    const press = () => this.#emit("act", { action });
    const button = h("button", { type: "button", class: look, data: { action }, onclick: press }, words);
    this.#buttons.push(button);
    return button;
  }

  /**
   * Which run is shown.
   *
   * @param {Job} job
   * @param {string} chosen
   */
  #picker(job, chosen) {
    const words = (/** @type {import("../types.js").RunItem} */ run) => `${speed(run.parameters.speed)}${run.state === "done" ? "" : `, ${stateText(run.state).toLowerCase()}`}`;
    const select = h(
      "select",
      { "aria-label": "Run", onchange: () => this.#emit("choose", { run: select.value }) },
      job.runs.map((run) => h("option", { value: run.id, selected: run.id === chosen }, words(run))),
    );
    return select;
  }

  /**
   * @param {string} name
   * @param {any} detail
   */
  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail, bubbles: true }));
  }
}

/** @param {Job} job */
const edit = (job) => h("a", { class: "button", href: `#/study?${new URLSearchParams({ job: job.id })}` }, "Edit a copy");

customElements.define("tb-job-head", JobHead);
