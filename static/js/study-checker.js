// @ts-check
/** Asks the server about a study as one types: after a pause, and only about the last one. */
import { api, ApiError } from "./api.js";

/** @typedef {import("./types.js").Finding} Finding */
/** @typedef {import("./types.js").Report} Report */
/** @typedef {import("./types.js").Study} Study */
/** @typedef {(report: Report | null, errors: Finding[]) => void} Answer report is null where the study could not be read at all */

/** Typing pauses this long before the server is asked. [ms] */
const PAUSE = 300;

export class StudyChecker {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {AbortController | null} */
  #asking = null;
  #answer;

  /** @param {Answer} answer */
  constructor(answer) {
    this.#answer = answer;
  }

  /** @param {{ kind: string, study: Study }} submission */
  ask(submission) {
    this.stop();
    this.#timer = setTimeout(() => void this.#check(submission), PAUSE);
  }

  /** What was asked is of no interest any more. */
  stop() {
    clearTimeout(this.#timer);
    this.#asking?.abort();
  }

  /** @param {{ kind: string, study: Study }} submission */
  async #check(submission) {
    const asking = new AbortController();
    this.#asking = asking;
    try {
      const report = await api.validate(submission, asking.signal);
      if (!asking.signal.aborted) this.#answer(report, report.errors);
    } catch (error) {
      if (!asking.signal.aborted) this.#answer(null, findingsOf(error));
    }
  }
}

/**
 * What a refusal says, as findings.
 *
 * @param {unknown} error
 * @returns {Finding[]}
 */
export function findingsOf(error) {
  const problem = /** @type {ApiError} */ (error);
  return problem.findings?.length ? problem.findings : [{ pointer: "", reason: problem.message }];
}
