// @ts-check
/**
 * A study or a part of one as JSON, to read, edit and paste; errors beside their lines. Emits `source` {value} where
 * the text can be read, `unreadable` where not.
 */
import { h, show } from "../dom.js";
import { lineOf, read } from "../json-source.js";
import { sentence } from "./finding-lines.js";

/** @typedef {import("../types.js").Finding} Finding */
/** @typedef {import("../types.js").Study} Study */
/** @typedef {{ line: number, text: string, kind: "error" | "warning" }} Remark */

export class StudyJson extends HTMLElement {
  #label = h("label", { for: "study-json" }, "The study as JSON, all values in SI units");
  #numbers = h("div", { class: "line-numbers", "aria-hidden": "true" });
  #text = h("textarea", { id: "study-json", spellcheck: "false", autocomplete: "off", wrap: "off", "aria-describedby": "study-json-remarks" });
  #remarks = h("ol", { class: "remarks-by-line", id: "study-json-remarks", role: "status" });
  /** @type {import("../json-source.js").Source} */
  #source = read("{}");
  /** @type {Finding[]} */
  #errors = [];
  /** @type {Finding[]} */
  #warnings = [];

  connectedCallback() {
    this.#text.addEventListener("input", () => this.#typed());
    this.#text.addEventListener("scroll", () => this.#follow());
    show(
      this,
      this.#label,
      h("div", { class: "source card" }, this.#numbers, this.#text),
      this.#remarks,
    );
  }

  /** What the text is, in words. @param {string} words */
  set called(words) {
    show(this.#label, `${words} as JSON, all values in SI units`);
  }

  /** @param {Study} study or part */
  set study(study) {
    const text = JSON.stringify(study, null, 2);
    if (text === this.#text.value) return;
    this.#text.value = text;
    this.#source = read(text);
    this.#mark();
  }

  /** Whether the text is no JSON. */
  get broken() {
    return this.#source.error !== null;
  }

  /**
   * @param {Finding[]} errors
   * @param {Finding[]} warnings
   */
  place(errors, warnings) {
    const has = /** @param {Finding} finding */ (finding) => finding.pointer !== "";
    this.#errors = errors.filter(has);
    this.#warnings = warnings.filter(has);
    this.#mark();
  }

  focus() {
    this.#text.focus();
  }

  #typed() {
    this.#source = read(this.#text.value);
    const { error, value } = this.#source;
    this.#errors = [];
    this.#warnings = [];
    this.#mark();
    const study = value && typeof value === "object" && !Array.isArray(value) ? (value.study ?? value) : null;
    const name = error === null && study ? "source" : "unreadable";
    this.dispatchEvent(new CustomEvent(name, { detail: { value: study }, bubbles: true }));
  }

  /** @returns {Remark[]} */
  #list() {
    const { error, lines } = this.#source;
    if (error) return [{ line: error.line, text: `${error.message} (column ${error.column}).`, kind: "error" }];
    /** @param {"error" | "warning"} kind @returns {(finding: Finding) => Remark} */
    const remark = (kind) => (finding) => ({ line: lineOf(lines, finding.pointer), text: sentence(finding), kind });
    const placed = [...this.#errors.map(remark("error")), ...this.#warnings.map(remark("warning"))];
    return placed.sort((a, b) => a.line - b.line);
  }

  #mark() {
    const list = this.#list();
    const count = this.#text.value.split("\n").length;
    const kinds = new Map(list.toReversed().map((remark) => [remark.line, remark.kind]));
    show(
      this.#numbers,
      Array.from({ length: count }, (_, index) => {
        const kind = kinds.get(index + 1);
        return h("span", { class: kind ?? null }, kind === "error" ? "✕ " : kind ? "! " : "", index + 1);
      }),
    );
    show(this.#remarks, list.map((remark) => this.#line(remark)));
    this.#text.setAttribute("aria-invalid", String(list.some((remark) => remark.kind === "error")));
    this.#follow();
  }

  /** @param {Remark} remark */
  #line({ line, text, kind }) {
    return h(
      "li",
      { class: `field-${kind}` },
      h("button", { type: "button", class: "link", onclick: () => this.#go(line) }, `Line ${line}`),
      kind === "error" ? ": " : ", warning: ",
      text,
    );
  }

  /** @param {number} line */
  #go(line) {
    const lines = this.#text.value.split("\n");
    const start = lines.slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
    this.#text.focus();
    this.#text.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
    const height = this.#text.scrollHeight / lines.length;
    this.#text.scrollTop = Math.max(0, (line - 6) * height);
  }

  #follow() {
    this.#numbers.scrollTop = this.#text.scrollTop;
  }
}

customElements.define("tb-study-json", StudyJson);
