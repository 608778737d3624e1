// @ts-check
/** The report of a job: what stands at its head, a preview, and the files. */
import { api, reportUrl } from "../api.js";
import { h, show } from "../dom.js";
import { link, remember } from "../router.js";

/** @typedef {import("../types.js").Job} Job */

/** Typing pauses this long before the preview is fetched again. [ms] */
const PAUSE = 700;
/** @type {[string, string, number][]} name in the address, title, longest text */
const TEXTS = [
  ["project", "Project", 200],
  ["author", "Author", 200],
  ["date", "Date", 40],
];

export class ReportPage extends HTMLElement {
  /** @type {import("../router.js").Route} */
  route = { name: "report", parts: [], query: new URLSearchParams() };
  /** @type {Job | null} */
  #job = null;
  #frame = h("iframe", { title: "Preview of the report", class: "report-preview" });
  #files = h("div", { class: "row report-files" });
  #said = h("p", { class: "soft small", role: "status" });
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  connectedCallback() {
    show(this, h("div", { class: "skeleton" }));
    void this.#open();
  }

  disconnectedCallback() {
    clearTimeout(this.#timer);
  }

  async #open() {
    const [id] = this.route.parts;
    try {
      const job = await api.job(id);
      if (!this.isConnected) return;
      this.#job = job;
      document.title = `Report · ${job.name} · Trainbridge`;
      const done = job.runs.some((/** @type {any} */ run) => run.state === "done");
      show(
        this,
        h("p", { class: "crumb" }, h("a", { href: link("jobs") }, "Jobs"), " / ", h("a", { href: link("jobs", id) }, job.name)),
        h("h1", null, "Report"),
        done ? this.#layout() : early(job),
      );
      if (done) this.#preview();
    } catch (error) {
      show(this, h("div", { class: "notice bad", role: "alert" }, h("p", null, /** @type {Error} */ (error).message)));
    }
  }

  #layout() {
    return h(
      "div",
      { class: "report" },
      h("aside", { class: "card stack" }, TEXTS.map((text) => this.#text(...text)), this.#remark(), this.#files, this.#said),
      h("div", { class: "card report-paper" }, this.#frame),
    );
  }

  /**
   * @param {string} name
   * @param {string} title
   * @param {number} most
   */
  #text(name, title, most) {
    const value = this.route.query.get(name) ?? this.#standard(name);
    const input = h("input", { id: `report-${name}`, name, type: "text", maxlength: most, autocomplete: "off", value, oninput: () => this.#typed(name, input.value) });
    return h("div", { class: "entry-text" }, h("label", { for: `report-${name}` }, title), input);
  }

  #remark() {
    const input = h("textarea", { id: "report-remark", name: "remark", rows: 4, maxlength: 2000, oninput: () => this.#typed("remark", input.value) }, this.route.query.get("remark") ?? "");
    return h("div", { class: "entry-text" }, h("label", { for: "report-remark" }, "Remark"), input);
  }

  /** What stands there if nobody wrote anything. @param {string} name */
  #standard(name) {
    if (name === "project") return this.#job?.name ?? "";
    return name === "date" ? today() : "";
  }

  /**
   * @param {string} name
   * @param {string} text
   */
  #typed(name, text) {
    remember(name, text === this.#standard(name) ? null : text);
    this.#links();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#preview(), PAUSE);
  }

  /** @returns {Record<string, string>} */
  #head() {
    const inputs = /** @type {NodeListOf<HTMLInputElement>} */ (this.querySelectorAll("[name]"));
    return Object.fromEntries([...inputs].map((input) => [input.name, input.value.trim()]));
  }

  #links() {
    const id = this.route.parts[0];
    const head = this.#head();
    show(
      this.#files,
      h("a", { class: "button primary", href: reportUrl(id, "pdf", head), download: "" }, "Download PDF"),
      h("a", { class: "button", href: reportUrl(id, "html", head), download: "" }, "Download HTML"),
    );
  }

  #preview() {
    this.#links();
    show(this.#said, "Writing the preview…");
    this.#frame.onload = () => show(this.#said, "The PDF holds the same, with page numbers.");
    this.#frame.src = reportUrl(this.route.parts[0], "html", { ...this.#head(), preview: "true" });
  }
}

/** As the visitor's calendar has it. */
function today() {
  const now = new Date();
  return [now.getFullYear(), now.getMonth() + 1, now.getDate()].map((part) => String(part).padStart(2, "0")).join("-");
}

/** @param {Job} job */
function early(job) {
  return h("div", { class: "notice" }, h("p", null, "There is nothing to report yet: no run of this job is done. ", h("a", { href: link("jobs", job.id) }, "Watch the job")));
}

customElements.define("tb-report-page", ReportPage);
