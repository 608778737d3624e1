// @ts-check
/** Where a study to be edited comes from: a template, or a job that ran. */
import { api } from "./api.js";
import { at } from "./pointer.js";

/** @typedef {import("./types.js").Template} Template */
/** @typedef {import("./study-model.js").Origin} Origin */
/** @typedef {import("./router.js").Route} Route */
/** @typedef {Origin & { title: string, description: string, called: string, examples: Template[] }} Beginning */

/**
 * @param {Route} route
 * @returns {Promise<Beginning>}
 */
export async function beginningOf(route) {
  const job = route.query.get("job");
  const [{ items }, own] = await Promise.all([api.templates(), job ? fromJob(job) : null]);
  const examples = /** @type {Template[]} */ (items);
  if (own) return { ...own, examples };
  const [name = ""] = route.parts;
  const template = examples.find((item) => item.name === name);
  if (!template) throw new Error(`There is no study named ${name} to start from.`);
  return {
    source: `template ${name}`,
    kind: template.kind ?? "crossing",
    study: template.study,
    title: template.title,
    description: template.description,
    called: "the template",
    examples,
  };
}

/** @param {string} id */
async function fromJob(id) {
  const [job, study] = await Promise.all([api.job(id), api.jobStudy(id)]);
  return {
    source: `job ${id}`,
    kind: job.kind,
    study,
    title: job.name,
    description: `A copy of the study of this job; the job itself stays as it is.`,
    called: "the job’s study",
  };
}

/**
 * What an alternative holds when it is chosen: as the study came, else as a template has it where
 * the solver's defaults alone are not a whole part, else the defaults.
 *
 * @param {Pick<Beginning, "study" | "examples">} beginning
 * @param {string} pointer
 * @param {import("./form-plan.js").Option} option
 */
export function alternative({ study, examples }, pointer, option) {
  const fits = (/** @type {any} */ part) => part && Object.values(part).includes(option.tag);
  if (fits(at(study, pointer))) return at(study, pointer);
  const example = option.complete ? null : examples.map((item) => at(item.study, pointer)).find(fits);
  return example ?? option.initial;
}
