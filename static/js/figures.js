// @ts-check
/**
 * Where a chart's figure comes from: one run, all runs of a job, or runs beside each other.
 *
 * A source answers with the figure as JSON and knows the address of the same figure as a file, so
 * that what is exported is what is seen.
 */
import { api, channelUrl, compareFigureUrl, jobFigureUrl, runFigureUrl } from "./api.js";

/** @typedef {import("./types.js").Figure} Figure */
/** @typedef {import("./types.js").FigureFormat} FigureFormat */
/** @typedef {import("./types.js").FigureQuery} FigureQuery */
/** @typedef {import("./types.js").FigureSource} FigureSource */

/**
 * A figure of one run.
 *
 * @param {string} run
 * @param {string} name
 * @returns {FigureSource}
 */
export function runFigure(run, name) {
  return {
    ...source(name, (format, query) => runFigureUrl(run, name, format, query)),
    channels: async () => (await api.channels(run)).items,
    channelUrl: (channel) => channelUrl(run, channel),
  };
}

/**
 * A figure of all runs of a job.
 *
 * @param {string} job
 * @param {string} name
 * @returns {FigureSource}
 */
export function jobFigure(job, name) {
  return source(name, (format, query) => jobFigureUrl(job, name, format, query));
}

/**
 * A figure of several runs beside each other, the first being the baseline.
 *
 * @param {string[]} runs
 * @param {string} name
 * @returns {FigureSource}
 */
export function compareFigure(runs, name) {
  return source(name, (format, query) => compareFigureUrl(runs, name, format, query));
}

/**
 * @param {string} name
 * @param {(format: FigureFormat, query?: FigureQuery) => string} url
 * @returns {FigureSource}
 */
function source(name, url) {
  return { name, url, json: (query, signal) => api.figure(url("json", query), signal) };
}
