// @ts-check
/** Set up a study: form or JSON on the left, Run, drawing and cost beside it; checked as one types. */
import { forgetLibrary } from "../components/library-choice.js";
import { StudyDrawing } from "../components/study-drawing.js";
import { StudyExport } from "../components/study-export.js";
import { StudyForm } from "../components/study-form.js";
import { StudyJson } from "../components/study-json.js";
import { leftAsTheyWere, resumedNotice, toMend } from "../components/study-notices.js";
import { StudyReport } from "../components/study-report.js";
import { StudyRun } from "../components/study-run.js";
import { StudyToolbar } from "../components/study-toolbar.js";
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { Drafts } from "../drafts.js";
import { link } from "../router.js";
import { DECIDES } from "../sections.js";
import { store } from "../store.js";
import { findingsOf, StudyChecker } from "../study-checker.js";
import { StudyModel } from "../study-model.js";
import { alternative, beginningOf } from "../study-origin.js";

/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../types.js").Report} Report */
/** @typedef {import("../study-origin.js").Beginning} Beginning */
/** @typedef {{ pointer: string, value: any, whole: boolean, option?: import("../form-plan.js").Option }} Edit */

export class StudyPage extends HTMLElement {
  /** @type {import("../router.js").Route} */
  route = { name: "study", parts: [], query: new URLSearchParams() };
  #ended = new AbortController();
  #checker = new StudyChecker((report, errors) => this.#show(report, errors));
  #form = /** @type {StudyForm} */ (h("tb-study-form"));
  #json = /** @type {StudyJson} */ (h("tb-study-json", { hidden: true }));
  #toolbar = /** @type {StudyToolbar} */ (h("tb-study-toolbar"));
  #drawing = /** @type {StudyDrawing} */ (h("tb-study-drawing", { class: "card" }));
  #report = /** @type {StudyReport} */ (h("tb-study-report", { class: "card" }));
  #export = /** @type {StudyExport} */ (h("tb-study-export"));
  #run = /** @type {StudyRun} */ (h("tb-study-run", { class: "card" }));
  #notice = h("div", { class: "study-notice", role: "status" });
  #heading = h("h1");

  async connectedCallback() {
    show(this, h("div", { class: "skeleton" }));
    try {
      const meta = await store.get("meta");
      const [beginning, document] = await Promise.all([beginningOf(this.route), api.schema(meta.openapi_url ?? "/api/v1/openapi.json")]);
      if (!this.#ended.signal.aborted) this.#begin(beginning, new StudyModel(beginning, document, new Drafts()));
    } catch (error) {
      show(this, h("div", { class: "notice bad", role: "alert" }, h("p", null, /** @type {Error} */ (error).message)));
    }
  }

  disconnectedCallback() {
    this.#ended.abort();
    this.#checker.stop();
  }

  /** @param {Beginning} beginning @param {StudyModel} model */
  #begin(beginning, model) {
    forgetLibrary();
    document.title = `${beginning.title} · Trainbridge`;
    show(
      this,
      h("p", { class: "crumb" }, h("a", { href: "#/" }, "Home"), " / Study"),
      this.#heading,
      beginning.description && h("p", { class: "soft lead" }, beginning.description),
      this.#notice,
      h("div", { class: "study" },
        h("div", { class: "study-inputs" }, this.#toolbar, this.#form, this.#json),
        h("aside", { "aria-label": "Run, drawing and check" }, this.#run, this.#drawing, this.#report)),
      this.#export,
    ); // prettier-ignore
    this.#run.bind(model.kind);
    this.#toolbar.bind({
      undo: () => this.#step(model, "undo"),
      redo: () => this.#step(model, "redo"),
      restart: () => model.restart(),
      copy: () => this.#export.open({ study: model.study, kind: model.kind, origin: location.origin }),
      view: (name) => this.#view(name),
    });
    this.#form.bind(model);
    this.#json.study = model.study;
    show(this.#notice, resumedNotice(model, beginning.called, () => show(this.#notice)));
    this.#follow(model, beginning);
    this.#changed(model, beginning);
    const asked = this.route.query.get("field");
    if (asked) this.#form.reach(asked);
  }

  /** @param {StudyModel} model @param {Beginning} beginning */
  #follow(model, beginning) {
    const { signal } = this.#ended;
    /** @param {EventTarget} target @param {string} name @param {(detail: any) => void} act */
    const on = (target, name, act) => target.addEventListener(name, (event) => act(/** @type {CustomEvent} */ (event).detail), { signal });
    on(model, "change", ({ way }) => this.#redraw(way, model, beginning));
    on(this, "edit", (edit) => this.#edit(edit, model, beginning));
    on(this, "source", ({ value }) => model.replace(value, "source"));
    on(this, "unreadable", () => this.#run.say(false, this.#toMend()));
    on(this, "refused", ({ refused }) => show(this.#notice, leftAsTheyWere(refused)));
    on(this, "submit-study", ({ kind }) => void this.#submit(kind, model));
    document.addEventListener("keydown", (event) => this.#key(event, model), { signal });
  }

  /** @param {Edit} edit @param {StudyModel} model @param {Beginning} beginning */
  #edit({ pointer, value, whole, option }, model, beginning) {
    if (value === undefined) this.#run.say(false, this.#toMend());
    else model.set(pointer, option ? alternative(beginning, pointer, option) : value, whole || pointer === DECIDES ? "whole" : "typing");
  }

  /** @param {import("../study-model.js").Way} way @param {StudyModel} model @param {Beginning} beginning */
  #redraw(way, model, beginning) {
    if (way !== "typing") this.#form.draw();
    if (way !== "source") this.#json.study = model.study;
    this.#changed(model, beginning);
  }

  /** @param {StudyModel} model @param {Beginning} beginning */
  #changed(model, { title, called }) {
    const { study, kind } = model;
    const { canUndo, canRedo } = model.history;
    show(this.#heading, typeof study.name === "string" && study.name ? study.name : title);
    this.#drawing.draw(study, kind);
    this.#form.refresh();
    this.#toolbar.update({ canUndo, canRedo, changes: model.changes.length, called });
    this.#toolbar.sections = this.#form.sections;
    this.#run.say(false, "Checking…");
    this.#checker.ask({ kind, study });
  }

  /** @param {Report | null} report @param {Finding[]} errors */
  #show(report, errors) {
    const warnings = report?.warnings ?? [];
    const lost = this.#form.place(errors, warnings);
    this.#json.place(errors, warnings);
    this.#report.update(report, lost);
    this.#toolbar.sections = this.#form.sections;
    const fine = errors.length === 0 && !this.#form.broken && !this.#json.broken;
    this.#run.say(fine, fine ? "Checked: ready to run." : this.#toMend());
  }

  /** Which inputs to mend; each leads there. */
  #toMend() {
    if (this.#json.broken) return toMend([{ name: "JSON text", focus: () => this.#view("json") }]);
    const go = /** @param {HTMLElement} place */ (place) => {
      this.#view("form");
      place.focus();
    };
    return toMend(this.#form.marked.map((place) => ({ name: place.name, focus: () => go(place) })));
  }

  /** @param {string} name */
  #view(name) {
    this.#form.hidden = name === "json";
    this.#json.hidden = name !== "json";
    this.#toolbar.view = name;
  }

  /** @param {StudyModel} model @param {"undo" | "redo"} way */
  #step(model, way) {
    // What was typed and is no value is the last step: the inputs show the study again.
    if (way === "undo" && (this.#form.broken || this.#json.broken)) model.dispatchEvent(new CustomEvent("change", { detail: { way: "whole" } }));
    else model[way]();
  }

  /** @param {KeyboardEvent} event @param {StudyModel} model */
  #key(event, model) {
    if (!(event.ctrlKey || event.metaKey) || event.target instanceof HTMLTextAreaElement) return;
    const key = event.key.toLowerCase();
    const way = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : null;
    if (way) {
      event.preventDefault();
      this.#step(model, way);
    } else if (key === "enter") this.#run.press();
  }

  /** @param {string} kind @param {StudyModel} model */
  async #submit(kind, { study }) {
    this.#run.say(false, "Starting…");
    try {
      const job = await api.submit({ kind, study });
      if (this.isConnected) location.hash = link("jobs", job.id); // whoever left meanwhile is not called back
    } catch (error) {
      const errors = findingsOf(error);
      if (errors.some((finding) => finding.pointer)) this.#show(null, errors);
      else this.#run.say(true, h("strong", { class: "field-error" }, errors[0].reason)); // a full queue may have room soon
    }
  }
}

customElements.define("tb-study-page", StudyPage);
