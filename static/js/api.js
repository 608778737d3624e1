// @ts-check
/** The only place that calls fetch. Every refusal becomes an ApiError that can be shown. */

/** @typedef {import("./types.js").Finding} Finding */
/** @typedef {import("./types.js").Study} Study */
/** @typedef {import("./types.js").FigureFormat} FigureFormat */
/** @typedef {import("./types.js").FigureQuery} FigureQuery */

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

/**
 * A text that is no JSON.
 *
 * @param {string} path
 * @returns {Promise<string>}
 */
async function sendText(path) {
  const response = await fetch(path).catch(() => null);
  if (!response) throw new ApiError(0, { detail: "The server does not answer. Is it still running?" });
  const text = await response.text();
  if (!response.ok) throw new ApiError(response.status, parse(text));
  return text;
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
 * What a figure or picture is asked for, as the end of its address.
 *
 * @param {Record<string, any>} query
 * @param {[string, string][]} [first]
 */
function asked({ channels, ...query }, first = []) {
  const parameters = new URLSearchParams(first);
  for (const [key, value] of Object.entries(query)) {
    if (value !== undefined && value !== "") parameters.set(key, String(value));
  }
  for (const channel of channels ?? []) parameters.append("channels", channel);
  const text = parameters.toString();
  return text ? `?${text}` : "";
}

/**
 * @param {string} run
 * @param {string} figure
 * @param {FigureFormat} format
 * @param {FigureQuery} [query]
 */
export function runFigureUrl(run, figure, format, query = {}) {
  return `${at("runs", run, "plots", `${figure}.${format}`)}${asked(query)}`;
}

/**
 * @param {string} job
 * @param {string} figure
 * @param {FigureFormat} format
 * @param {FigureQuery} [query]
 */
export function jobFigureUrl(job, figure, format, query = {}) {
  return `${at("jobs", job, "plots", `${figure}.${format}`)}${asked(query)}`;
}

/**
 * @param {string[]} runs the first is the baseline
 * @param {string} figure
 * @param {FigureFormat} format
 * @param {FigureQuery} [query]
 */
export function compareFigureUrl(runs, figure, format, query = {}) {
  const { channels, ...rest } = query;
  const first = [...runs.map((run) => ["run", run]), ...(channels ?? []).map((name) => ["channel", name])];
  return `${at("compare", "plots", `${figure}.${format}`)}${asked(rest, /** @type {[string, string][]} */ (first))}`;
}

/**
 * @param {string} run
 * @param {string} channel
 */
export function channelUrl(run, channel) {
  return at("runs", run, "channels", `${channel}.csv`);
}

/** @param {string} job */
export const logUrl = (job) => at("jobs", job, "log");

/** The study of a job, as JSON. @param {string} job */
export const studyUrl = (job) => at("jobs", job, "study");

/** The run with summary and verdicts, as JSON. @param {string} run */
export const runUrl = (run) => at("runs", run);

/**
 * A picture of the 3D view, drawn by the server.
 *
 * @param {string} run
 * @param {Record<string, string | number>} look
 */
export const stillUrl = (run, look) => `${at("runs", run, "viewer", "still.png")}${asked(look)}`;

/**
 * The 3D view as one file that opens without the server.
 *
 * @param {string} run
 * @param {Record<string, string | number>} look
 */
export const replayUrl = (run, look) => `${at("runs", run, "viewer", "replay.html")}${asked(look)}`;

/**
 * Entries of the library as a file: all, of one kind, or one.
 *
 * @param {string} [kind]
 * @param {string} [id]
 */
export const libraryUrl = (kind, id) => at("library", ...[kind, id].filter((part) => part !== undefined));

/**
 * A job's report as a file.
 *
 * @param {string} job
 * @param {"html" | "pdf"} format
 * @param {Record<string, string>} head project, author, date, remark; `preview` to look at it
 */
export const reportUrl = (job, format, head) => `${at("jobs", job, `report.${format}`)}${asked(head)}`;

/** @param {string[]} jobs */
export function eventsUrl(jobs) {
  const parameters = new URLSearchParams(jobs.map((job) => ["job", job]));
  return `${ROOT}/events${jobs.length ? `?${parameters}` : ""}`;
}

export const api = {
  meta: () => send("GET", at("meta")),
  /** @returns {Promise<import("./types.js").Machine>} */
  machine: () => send("GET", at("machine")),
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
  /**
   * Jobs of some states whose name holds a text.
   *
   * @param {{ states: string[], name: string, cursor?: string | null }} filter
   */
  findJobs: ({ states, name, cursor }) => {
    const parameters = new URLSearchParams(states.map((state) => ["state", state]));
    if (name) parameters.set("name", name);
    if (cursor) parameters.set("cursor", cursor);
    return send("GET", `${at("jobs")}?${parameters}`);
  },
  /** @param {string} kind @returns {Promise<{ items: import("./types.js").LibraryItem[] }>} */
  library: (kind) => send("GET", at("library", kind)),
  wholeLibrary: () => send("GET", at("library")),
  /**
   * @param {string} kind
   * @param {string} id
   * @returns {Promise<import("./types.js").LibraryItem>}
   */
  entry: (kind, id) => send("GET", at("library", kind, id)),
  /**
   * @param {string} kind
   * @param {import("./types.js").LibraryEntry} entry
   * @returns {Promise<import("./types.js").LibraryItem>}
   */
  addEntry: (kind, entry) => send("POST", at("library", kind), entry),
  /**
   * @param {string} kind
   * @param {string} id
   * @param {import("./types.js").LibraryEntry} entry
   * @returns {Promise<import("./types.js").LibraryItem>}
   */
  changeEntry: (kind, id, entry) => send("PUT", at("library", kind, id), entry),
  /**
   * @param {string} kind
   * @param {string} id
   */
  removeEntry: (kind, id) => send("DELETE", at("library", kind, id)),
  /**
   * @param {unknown} document as `wholeLibrary` gives it
   * @returns {Promise<{ items: import("./types.js").LibraryItem[], skipped: string[] }>}
   */
  importLibrary: (document) => send("POST", at("library"), document),
  /**
   * @param {string[]} runs the first is the baseline
   * @param {AbortSignal} [signal]
   * @returns {Promise<import("./types.js").Comparison>}
   */
  compare: (runs, signal) => send("GET", `${at("compare")}?${new URLSearchParams(runs.map((run) => ["run", run]))}`, undefined, signal),
  /** @param {string} id */
  jobStudy: (id) => send("GET", at("jobs", id, "study")),
  /** @param {string} id */
  jobLog: (id) => sendText(logUrl(id)),
  /** @param {string} id */
  retry: (id) => send("POST", at("jobs", id, "retry")),
  /** @param {string} id */
  clone: (id) => send("POST", at("jobs", id, "clone")),
  /** @param {string} id */
  removeJob: (id) => send("DELETE", at("jobs", id)),
  /**
   * @param {string} id
   * @param {number} priority greater ones begin first
   */
  prioritise: (id, priority) => send("PATCH", at("jobs", id), { priority }),
  /** @param {string} run */
  figures: (run) => send("GET", at("runs", run, "plots")),
  /**
   * @param {string} run
   * @param {number} points
   */
  frames: (run, points) => send("GET", `${at("runs", run, "frames")}?points=${points}`),
  /** @param {string} id */
  cancel: (id) => send("POST", at("jobs", id, "cancel")),
  /** @param {string} id */
  run: (id) => send("GET", at("runs", id)),
  /** @param {string} id */
  runVerdicts: (id) => send("GET", at("runs", id, "verdicts")),
  /** @param {string} id */
  channels: (id) => send("GET", at("runs", id, "channels")),
  /**
   * @param {string} address
   * @param {AbortSignal} [signal]
   * @returns {Promise<import("./types.js").Figure>}
   */
  figure: (address, signal) => send("GET", address, undefined, signal),
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
