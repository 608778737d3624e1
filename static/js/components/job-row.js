// @ts-check
/** One job of a list: name, what it computes, state, when; where it can be ticked, with its runs. */
import { h } from "../dom.js";
import { ago, number, remaining, speed, stateText } from "../format.js";
import { comparable } from "../job-filter.js";
import { subject } from "../job-words.js";
import { link } from "../router.js";

/** @typedef {import("../types.js").Job} Job */
/**
 * @typedef {{ jobs: Set<string>, runs: Set<string>, change: (job: Job, runs: string[], on: boolean) => void,
 *   opened: Set<string> }} Ticks ids of what is ticked; `change` is told of another tick
 */

/**
 * @param {Job} job
 * @param {Ticks | null} ticks null where nothing can be ticked
 */
export function jobRow(job, ticks) {
  const fraction = job.progress?.fraction ?? 0;
  const active = job.state === "running";
  const counted = active && job.kind !== "modes";
  const row = h(
    "a",
    { href: link("jobs", job.id) },
    h("span", { class: "job-name" }, job.name || job.kind),
    h("span", { class: "soft small job-what" }, subject(job)),
    h("span", { class: `tag ${job.state}` }, counted ? `${number(Math.floor(fraction * 100))} %` : stateText(job.state)),
    h(
      "span",
      { class: "soft small job-when" },
      active ? remaining(job.progress?.remaining) : ago(job.ended ?? job.started ?? job.created, Date.now()),
    ),
    counted && h("progress", { max: 1, value: fraction, "aria-label": `Progress of ${job.name}` }),
  );
  if (!ticks) return h("li", null, row);
  return h("li", { class: "tickable" }, jobTick(job, ticks), row, job.runs.length > 1 && runTicks(job, ticks));
}

/**
 * @param {Job} job
 * @param {Ticks} ticks
 */
function jobTick(job, ticks) {
  const runs = comparable(job);
  const box = h("input", { type: "checkbox", checked: ticks.jobs.has(job.id), "aria-label": `Select ${job.name}`, data: { tick: job.id }, onchange: () => ticks.change(job, runs, box.checked) });
  box.indeterminate = !box.checked && runs.some((run) => ticks.runs.has(run));
  return h("label", { class: "tick" }, box);
}

/**
 * The runs of a sweep, so that one speed can be compared with another.
 *
 * @param {Job} job
 * @param {Ticks} ticks
 */
function runTicks(job, ticks) {
  const done = new Set(comparable(job));
  if (!done.size) return null;
  const boxes = job.runs
    .filter((run) => done.has(run.id))
    .map((run) => {
      const box = h("input", { type: "checkbox", checked: ticks.runs.has(run.id), data: { tick: run.id }, onchange: () => ticks.change(job, [run.id], box.checked) });
      return h("label", null, box, speed(run.parameters.speed));
    });
  const details = h("details", { class: "run-ticks", open: ticks.opened.has(job.id) }, h("summary", null, `${done.size} speeds to choose from`), h("div", { class: "row" }, boxes));
  details.addEventListener("toggle", () => (details.open ? ticks.opened.add(job.id) : ticks.opened.delete(job.id)));
  return details;
}
