// @ts-check
/** The only place that calls fetch. Every refusal becomes an ApiError that can be shown. */

/** @typedef {import("./types.js").Finding} Finding */
/** @typedef {import("./types.js").Study} Study */

const ROOT = "/api/v1";

export class ApiError extends Error {
  /**
   * @param {number} status 0 where the server could not be reached
   * @param {{ title?: string, detail?: string, errors?: Finding[] }} problem
   */
  constructor(status, problem) {
    super(problem.detail || problem.title || `The server answered ${status}.`);
    this.name = "ApiError";
    this.status = status;
    this.findings = problem.errors ?? [];
  }
}

/**
 * @param {string} method
 * @param {string} path
 * @param {unknown} [body]
 * @param {AbortSignal} [signal]
 */
async function send(method, path, body, signal) {
  let response;
  try {
    response = await fetch(path, {
      method,
      signal,
      headers: body === undefined ? {} : { "Content-Type": "application/json" },
      body: body === undefined ? undefined : JSON.stringify(body),
    });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new ApiError(0, { detail: "The server does not answer. Is it still running?" });
  }
  const text = await response.text();
  const answer = text ? parse(text) : null;
  if (!response.ok) throw new ApiError(response.status, answer ?? { title: response.statusText });
  return answer;
}

/** @param {string} text */
function parse(text) {
  try {
    return JSON.parse(text);
  } catch {
    return { detail: text.slice(0, 200) };
  }
}

/**
 * A job's, run's or session's address.
 *
 * @param {...string} parts
 */
const at = (...parts) => [ROOT, ...parts.map(encodeURIComponent)].join("/");

/**
 * @param {string} run
 * @param {string} figure
 * @param {"json" | "png" | "svg" | "pdf"} format
 * @param {{ from?: number, to?: number, points?: number, channels?: string[] }} [query]
 */
export function figureUrl(run, figure, format, query = {}) {
  const parameters = new URLSearchParams();
  if (query.from !== undefined) parameters.set("from", String(query.from));
  if (query.to !== undefined) parameters.set("to", String(query.to));
  if (query.points !== undefined) parameters.set("points", String(query.points));
  for (const channel of query.channels ?? []) parameters.append("channels", channel);
  const text = parameters.toString();
  return `${at("runs", run, "plots", `${figure}.${format}`)}${text ? `?${text}` : ""}`;
}

/**
 * @param {string} run
 * @param {string} channel
 */
export function channelUrl(run, channel) {
  return at("runs", run, "channels", `${channel}.csv`);
}

/** @param {string[]} jobs */
export function eventsUrl(jobs) {
  const parameters = new URLSearchParams(jobs.map((job) => ["job", job]));
  return `${ROOT}/events${jobs.length ? `?${parameters}` : ""}`;
}

export const api = {
  meta: () => send("GET", at("meta")),
  templates: () => send("GET", at("templates")),
  /** @param {string} address */
  schema: (address) => send("GET", address),
  /**
   * @param {{ kind: string, study: Study }} submission
   * @param {AbortSignal} [signal]
   */
  validate: (submission, signal) => send("POST", at("studies", "validate"), submission, signal),
  /** @param {{ kind: string, study: Study }} submission */
  submit: (submission) => send("POST", at("jobs"), submission),
  /** @param {string | null} [cursor] `next` of the page before */
  jobs: (cursor) => send("GET", `${at("jobs")}${cursor ? `?${new URLSearchParams({ cursor })}` : ""}`),
  /** @param {string} id */
  job: (id) => send("GET", at("jobs", id)),
  /** @param {string} id */
  cancel: (id) => send("POST", at("jobs", id, "cancel")),
  /** @param {string} id */
  run: (id) => send("GET", at("runs", id)),
  /** @param {string} id */
  runVerdicts: (id) => send("GET", at("runs", id, "verdicts")),
  /** @param {string} id */
  channels: (id) => send("GET", at("runs", id, "channels")),
  /**
   * @param {string} run
   * @param {string} figure
   * @param {{ from?: number, to?: number, points?: number, channels?: string[] }} [query]
   * @param {AbortSignal} [signal]
   */
  figure: (run, figure, query, signal) =>
    send("GET", figureUrl(run, figure, "json", query), undefined, signal),
  /**
   * @param {string} run
   * @param {Record<string, unknown>} look
   */
  openViewer: (run, look) => send("POST", at("runs", run, "viewer"), look),
  /**
   * @param {string} session
   * @param {Record<string, unknown>} state
   */
  steerViewer: (session, state) => send("PUT", at("viewer", session), state),
  /** @param {string} session */
  viewer: (session) => send("GET", at("viewer", session)),
  /** @param {string} session */
  closeViewer: (session) => send("DELETE", at("viewer", session)),
};
