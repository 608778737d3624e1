// @ts-check
/** What each tab of a job shows: plots, tables, inputs, log, files. */
import { ComfortTable } from "./comfort-table.js";
import { FigureStack } from "./figure-stack.js";
import { JobFiles } from "./job-files.js";
import { JobInputs } from "./job-inputs.js";
import { JobLog } from "./job-log.js";
import { ModesTable } from "./modes-table.js";
import { PlaceForm } from "./place-form.js";
import { RunFacts } from "./run-facts.js";
import { SweepTable } from "./sweep-table.js";
import { h } from "../dom.js";
import { jobFigure, runFigure } from "../figures.js";
import { POINT_FIGURES, tabsOf } from "../job-tabs.js";
import { isActive } from "../job-words.js";
import { cameraAsked } from "../viewer-looks.js";

/** @typedef {import("../types.js").Job} Job */
/** @typedef {import("../types.js").Run} Run */
/** @typedef {import("../types.js").FigureItem} FigureItem */
/** @typedef {import("../run-view.js").RunView} RunView */
/**
 * @typedef {{ job: Job, run: string, view: RunView, library: string, figures: FigureItem[] }} Shown
 *   a job, which of its runs is shown and what there is to draw of it
 * @typedef {{ result: Run | null, judged: import("../job-words.js").Judged[], animated: boolean }} Found
 *   what the run and its sweep came to; whether shapes can be animated
 */

/** @type {FigureItem} */
const SWEEP = { name: "speed-sweep", title: "Speed sweep" };
/** Tabs where a point of the deck is chosen. */
const PLACED = new Set(["accelerations", "slab-map"]);
const NO_SPEED = "The first point appears with the first speed that is done.";

/**
 * The content of a tab.
 *
 * @param {string} id
 * @param {Shown} shown
 * @returns {HTMLElement}
 */
export function contentOf(id, shown) {
  const { job, run, view, library, figures } = shown;
  if (id === "inputs") {
    const inputs = /** @type {JobInputs} */ (h("tb-job-inputs"));
    void inputs.bind({ job: job.id, kind: job.kind });
    return inputs;
  }
  if (id === "log") {
    const log = /** @type {JobLog} */ (h("tb-job-log"));
    log.bind(job.id);
    log.active = isActive(job);
    return log;
  }
  if (id === "files") {
    const files = /** @type {JobFiles} */ (h("tb-job-files"));
    const time = view.cursor.time || view.look.time || 0;
    files.bind({ job, run, figures, time, mode: view.look.mode, camera: cameraAsked(view.look, time) });
    return files;
  }
  const own = tabsOf(job, figures).find((tab) => tab.id === id)?.figures ?? [];
  const stack = /** @type {FigureStack} */ (h("tb-figure-stack"));
  if (id === "sweep") stack.bind({ view, library, figures: [SWEEP], source: (name) => jobFigure(job.id, name), empty: NO_SPEED });
  else stack.bind({ view, library, figures: own, source: (name) => runFigure(run, name) });
  const pointed = PLACED.has(id) && figures.some(({ name }) => POINT_FIGURES.includes(name));
  return h("div", { class: "stack" }, pointed && placeForm(view), (own.length > 0 || id === "sweep") && stack, h("div", { class: "stack addition" }));
}

/** @param {RunView} view */
function placeForm(view) {
  const form = /** @type {PlaceForm} */ (h("tb-place-form"));
  form.view = view;
  return form;
}

/**
 * What stands under the plots of a tab once results are there.
 *
 * @param {string} id
 * @param {Shown} shown
 * @param {Found} found
 * @returns {HTMLElement[]}
 */
export function additionOf(id, { run, view }, { result, judged, animated }) {
  if (id === "sweep" && judged.length) {
    const table = /** @type {SweepTable} */ (h("tb-sweep-table"));
    table.bind(judged, run);
    return [table];
  }
  if (id === "vehicle" && result?.summary?.comfort) {
    const table = /** @type {ComfortTable} */ (h("tb-comfort-table"));
    table.comfort = result.summary.comfort;
    return [table];
  }
  if (id !== "overview" || !result) return [];
  const facts = /** @type {RunFacts} */ (h("tb-run-facts"));
  facts.run = result;
  if (!result.summary?.modes) return [facts];
  const table = /** @type {ModesTable} */ (h("tb-modes-table"));
  table.modes = result.summary.modes;
  table.chosen = animated ? view.look.mode : 0;
  return [table, facts];
}
