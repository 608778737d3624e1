// @ts-check
/** What there is of a run: which figures, how many pictures, how far apart. */
import { api } from "./api.js";
import { FIRST_FIGURES } from "./job-tabs.js";

/** @typedef {import("./types.js").FigureItem} FigureItem */

/**
 * Asks the server; what it does not know counts as nothing.
 *
 * @param {string} run
 * @returns {Promise<{ figures: FigureItem[], frames: number, interval: number }>} interval in s
 */
export async function runExtent(run) {
  const [figures, frames] = await Promise.all([
    api.figures(run).catch(() => FIRST_FIGURES),
    api.frames(run, 2).catch(() => ({ items: [] })),
  ]);
  const last = frames.items.at(-1);
  return {
    figures: figures.items ?? figures,
    frames: frames.items.length,
    interval: last?.index ? last.time / last.index : 0,
  };
}

/**
 * What there is of the run that is shown, though another may be chosen while the server is asked.
 *
 * @param {() => string} shown the run that is shown now
 */
export async function shownExtent(shown) {
  let run;
  let extent;
  do {
    run = shown();
    extent = await runExtent(run);
  } while (run !== shown());
  return extent;
}
