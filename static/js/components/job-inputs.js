// @ts-check
/** The study of a job as a table to read: units, and what differs from the template it came from. */
import { api } from "../api.js";
import { h, show } from "../dom.js";
import { store } from "../store.js";
import { closestTemplate, studySections } from "../study-rows.js";

/** @typedef {import("../types.js").Study} Study */
/** @typedef {import("../types.js").Template} Template */
/** @typedef {import("../study-rows.js").Row} Row */
/** @typedef {import("../study-rows.js").Section} Section */

export class JobInputs extends HTMLElement {
  #kind = "crossing";
  /** @type {Study} */
  #study = {};
  /** @type {any} */
  #document = null;
  /** @type {Template[]} */
  #templates = [];
  /** @type {Template | null} */
  #template = null;
  #body = h("div", { class: "input-sections" });
  #only = h("input", { type: "checkbox", onchange: () => this.#draw() });
  #choice = h("select", { "aria-label": "Template to compare with", onchange: () => this.#compare() });
  #said = h("p", { class: "soft small", role: "status" });

  /**
   * @param {{ job: string, kind: string }} job
   */
  async bind({ job, kind }) {
    this.#kind = kind;
    this.classList.add("card", "sheet");
    show(this, h("div", { class: "skeleton" }));
    try {
      const meta = await store.get("meta");
      const [study, templates, document] = await Promise.all([
        api.jobStudy(job),
        api.templates(),
        api.schema(meta.openapi_url ?? "/api/v1/openapi.json"),
      ]);
      this.#study = study;
      this.#templates = templates.items;
      this.#document = document;
      this.#template = closestTemplate(study, kind, templates.items);
      this.#frame(job);
      this.#draw();
    } catch (error) {
      show(this, h("p", { class: "soft" }, /** @type {Error} */ (error).message));
    }
  }

  /** @param {string} job */
  #frame(job) {
    show(
      this.#choice,
      this.#templates.map((item) => h("option", { value: item.name, selected: item === this.#template }, item.title)),
    );
    show(
      this,
      h(
        "div",
        { class: "row spread" },
        h("h2", null, "Inputs"),
        h("a", { class: "button", href: `#/study?${new URLSearchParams({ job })}` }, "Edit a copy"),
      ),
      h("div", { class: "row" }, h("label", { class: "inline" }, "Compared with ", this.#choice), h("label", { class: "inline" }, this.#only, "only what differs")),
      this.#said,
      this.#body,
    );
  }

  #compare() {
    this.#template = this.#templates.find((item) => item.name === this.#choice.value) ?? null;
    this.#draw();
  }

  #draw() {
    const sections = studySections(this.#study, this.#kind, this.#template?.study ?? null, this.#document);
    const rows = sections.flatMap((section) => section.groups).flatMap((group) => group.rows);
    const changed = rows.filter((row) => row.standard !== null).length;
    const kept = this.#only.checked ? sections.map(onlyChanged).filter((section) => section.groups.length) : sections;
    show(this.#said, changed ? `${changed} of ${rows.length} inputs differ from the template; a dot marks them.` : `All ${rows.length} inputs are the template's.`);
    show(this.#body, kept.map((section) => this.#section(section)));
  }

  /** @param {Section} section */
  #section({ title, groups }) {
    const rows = groups.flatMap((group) => group.rows);
    const changed = rows.filter((row) => row.standard !== null).length;
    const nested = groups.length > 1;
    return h(
      "details",
      { class: "input-section", open: rows.length < 40 || changed > 0 },
      h("summary", null, h("h3", null, title), h("span", { class: "soft small" }, changed ? `${changed} of ${rows.length} differ` : `${rows.length} inputs`)),
      h("div", { class: "input-groups" }, groups.map((group) => h("section", null, nested && group.title && h("h4", null, group.title), h("dl", null, group.rows.map(line))))),
    );
  }
}

/** @param {Section} section */
function onlyChanged(section) {
  const groups = section.groups.map((group) => ({ ...group, rows: group.rows.filter((row) => row.standard !== null) }));
  return { ...section, groups: groups.filter((group) => group.rows.length) };
}

/** @param {Row} row */
function line({ pointer, label, text, unit, standard, standardUnit }) {
  const changed = standard !== null;
  return h(
    "div",
    { class: changed ? "changed" : "", data: { pointer } },
    h("dt", null, changed && h("span", { class: "dot", role: "img", "aria-label": "differs from the template" }), label),
    h("dd", null, h("span", { class: "value" }, text), unit && h("span", { class: "soft" }, ` ${unit}`), changed && h("span", { class: "soft small was" }, `template: ${standard} ${standardUnit}`.trim())),
  );
}

customElements.define("tb-job-inputs", JobInputs);
