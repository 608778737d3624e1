// @ts-check
/** Run and Natural modes, and whether the study can be run. Emits `submit-study` {kind}. */
import { h, show } from "../dom.js";

export class StudyRun extends HTMLElement {
  #run = h("button", { type: "button", class: "primary", "aria-keyshortcuts": "Control+Enter", title: "Run (Ctrl+Enter)" }, "Run");
  #modes = h("button", { type: "button", title: "Frequencies, damping and shapes, without a crossing" }, "Natural modes");
  #state = h("p", { class: "soft small", role: "status" });

  /** @param {string} kind of the job */
  bind(kind) {
    this.#run.addEventListener("click", () => this.#send(kind));
    this.#modes.addEventListener("click", () => this.#send("modes"));
    show(this, this.#run, kind === "crossing" && this.#modes, this.#state);
  }

  /**
   * @param {boolean} ready
   * @param {import("../dom.js").Child} words
   */
  say(ready, words) {
    this.#run.disabled = !ready;
    this.#modes.disabled = !ready;
    show(this.#state, words);
  }

  /** As a click on Run, where it can be clicked. */
  press() {
    this.#run.click();
  }

  /** @param {string} kind */
  #send(kind) {
    this.dispatchEvent(new CustomEvent("submit-study", { detail: { kind }, bubbles: true }));
  }
}

customElements.define("tb-study-run", StudyRun);
