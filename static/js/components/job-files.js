// @ts-check
/** Everything of a job that can be kept: report, study, results, figures, histories, pictures. */
import { api, channelUrl, jobFigureUrl, logUrl, replayUrl, runFigureUrl, runUrl, stillUrl, studyUrl } from "../api.js";
import { found, groupText, groupsOf } from "../channel-choice.js";
import { h, show } from "../dom.js";
import { currentTheme } from "../theme.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Channel} Channel */
/** @typedef {import("../types.js").FigureItem} FigureItem */

const FORMATS = /** @type {const} */ (["png", "svg", "pdf", "csv"]);
/** Channels that are listed at once; words narrow them down. */
const ROWS = 40;

export class JobFiles extends HTMLElement {
  /**
   * @param {{ job: Job, run: string, figures: FigureItem[], time: number, mode: number, camera: Record<string, string> }} options
   *   `time` of the still picture [s]; `mode` of a modal analysis, counted from 1; `camera` of the picture
   */
  bind({ job, run, figures, time, mode, camera }) {
    this.classList.add("card", "sheet", "files-sheet");
    const ended = job.state === "done";
    const modal = job.kind === "modes";
    /** @type {Record<string, number>} */
    const look = modal ? { mode: mode - 1 } : {};
    const swept = job.runs.length > 1;
    show(
      this,
      h("h2", null, "Files"),
      ended && h("p", null, h("a", { class: "button primary", href: link("report", job.id) }, "Report"), h("span", { class: "soft small" }, " one file with inputs, verdicts and figures, as HTML or PDF")),
      group("The job", [
        ["Study", "every input, as it was computed", [["JSON", studyUrl(job.id)]]],
        ["Results", "summary and verdicts of this run", [["JSON", runUrl(run)]]],
        ["Log", "what happened, line by line", [["text", logUrl(job.id)]]],
      ]),
      group("Figures", [
        ...figures.map(({ name, title }) => row(title, (format) => runFigureUrl(run, name, format, { theme: currentTheme() }))),
        ...(swept ? [row("Speed sweep", (format) => jobFigureUrl(job.id, "speed-sweep", format, { theme: currentTheme() }))] : []),
      ]),
      group("3D view", [
        ["Picture", `as drawn by the server, ${modal ? `of mode ${mode}` : `at ${time.toFixed(3)} s`}`, [["PNG", stillUrl(run, { time: modal ? 0 : time, ...look, ...camera, theme: currentTheme(), width: 1600, height: 900 })]]],
        ["Replay", "one file that plays without the server", [["HTML", replayUrl(run, look)]]],
      ]),
      !modal && this.#channels(run),
    );
  }

  /** Histories of every channel, fetched when the list is opened. @param {string} run */
  #channels(run) {
    const search = h("input", { type: "search", "aria-label": "Search the channels", placeholder: "Search, e.g. wheel 03" });
    const kind = h("select", { "aria-label": "Kind of channel" });
    const rows = h("ul", { class: "plain-list" });
    const said = h("p", { class: "soft small", role: "status" });
    /** @type {Channel[] | null} */
    let all = null;
    const list = () => {
      const hits = found(all ?? [], { text: search.value, group: kind.value });
      show(rows, hits.slice(0, ROWS).map((channel) => h("li", null, h("a", { href: channelUrl(run, channel.name), download: "" }, channel.title || channel.name))));
      show(said, hits.length > ROWS ? `${hits.length} channels, the first ${ROWS} shown.` : `${hits.length} channels.`);
    };
    search.oninput = kind.onchange = list;
    const load = async () => {
      if (all) return;
      try {
        all = (await api.channels(run)).items;
        show(kind, h("option", { value: "" }, "All"), groupsOf(all ?? []).map((name) => h("option", { value: name }, groupText(name))));
        list();
      } catch (error) {
        show(said, /** @type {Error} */ (error).message);
      }
    };
    return h("details", { ontoggle: () => void load() }, h("summary", null, "Histories of every channel, as CSV in SI units"), h("div", { class: "row" }, search, kind), rows, said);
  }
}

/**
 * @param {string} title
 * @param {(format: typeof FORMATS[number]) => string} url
 * @returns {[string, string, [string, string][]]}
 */
const row = (title, url) => [title, "", FORMATS.map((format) => [format.toUpperCase(), url(format)])];

/**
 * @param {string} title
 * @param {[string, string, [string, string][]][]} rows name, what it is, files
 */
function group(title, rows) {
  if (!rows.length) return null;
  return h(
    "section",
    null,
    h("h3", null, title),
    h(
      "ul",
      { class: "file-rows" },
      rows.map(([name, words, files]) =>
        h("li", null, h("span", null, name, words && h("span", { class: "soft small" }, ` ${words}`)), h("span", { class: "row files" }, files.map(([text, href]) => h("a", { href, download: "", "aria-label": `${name}, ${text}` }, text)))),
      ),
    ),
  );
}

customElements.define("tb-job-files", JobFiles);
