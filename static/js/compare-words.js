// @ts-check
/** Runs side by side, in words: their names, their inputs, how much a result changed. Pure. */
import { number, speed, unitText } from "./format.js";
import { abridged, counted } from "./ranges.js";
import { nameOf } from "./schema.js";
import { titleOf, words } from "./titles.js";

/** @typedef {import("./types.js").ComparedRun} ComparedRun */
/** @typedef {import("./types.js").ComparedInput} ComparedInput */
/** @typedef {import("./types.js").ComparedResult} ComparedResult */
/** @typedef {import("./types.js").Unit} Unit */

/** As many runs as the server puts side by side. */
export const MOST = 12;
/** From this change on a factor is easier to read than a percentage. */
const MANY = 10;
/** Changes below this are rounding. */
const NONE = 5e-7;

/**
 * The runs of an address, the baseline first; each once, and not too many.
 *
 * @param {URLSearchParams} query
 * @returns {string[]}
 */
export function runsOf(query) {
  const runs = [...new Set((query.get("runs") ?? "").split(",").filter((run) => /^[0-9a-zA-Z]{1,64}$/.test(run)))].slice(0, MOST);
  const base = query.get("base") ?? "";
  return runs.includes(base) ? [base, ...runs.filter((run) => run !== base)] : runs;
}

/**
 * A name for each run, as short as tells them apart.
 *
 * @param {ComparedRun[]} runs
 * @returns {string[]}
 */
export function runNames(runs) {
  const sameJob = new Set(runs.map((run) => run.name)).size === 1;
  const names = runs.map((run) => {
    const moving = run.kind === "modes" ? "modes" : Number.isFinite(run.parameters.speed) ? speed(run.parameters.speed) : "";
    if (sameJob && moving && run.runs > 1) return moving;
    return [run.name, moving].filter(Boolean).join(", ");
  });
  const twice = (/** @type {string} */ name) => names.filter((other) => other === name).length > 1;
  return names.map((name, index) => (twice(name) ? `${name} (${runs[index].id.slice(0, 4)})` : name));
}

/**
 * What an input is called: its section and its own name.
 *
 * @param {string} pointer
 * @returns {{ section: string, name: string }}
 */
export function inputName(pointer) {
  const [first, ...rest] = pointer.split("/").slice(1);
  if (!rest.length) return { section: "Study", name: titleOf(pointer, words(first)) };
  const inner = rest.slice(0, -1).filter((part) => !/^\d+$/.test(part));
  const index = rest.find((part) => /^\d+$/.test(part));
  const within = inner.length ? `${words(inner[inner.length - 1]).replace(/s$/, index ? "" : "s")}${index ? ` ${Number(index) + 1}` : ""}: ` : "";
  const own = titleOf(pointer, nameOf(pointer));
  return { section: words(first), name: within ? `${within}${own.charAt(0).toLowerCase()}${own.slice(1)}` : own };
}

/**
 * The text of an input's value; a dash where a study has no such input.
 *
 * @param {any} value SI
 * @param {Unit | null} unit
 * @returns {string}
 */
export function inputText(value, unit) {
  if (value === null || value === undefined) return "–";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return `${number(value * (unit?.scale ?? 1), 6)} ${unitText(unit)}`.trim();
  if (!Array.isArray(value)) return String(value).replaceAll("_", " ");
  if (value.every((item) => typeof item === "number")) return `${abridged(value.map((item) => item * (unit?.scale ?? 1)))} ${unitText(unit)}`.trim();
  return counted(value.map(String)).replaceAll("_", " ");
}

/**
 * The texts of an input's values side by side. Long lists are shortened; where that hides the
 * difference from the first one, the text says where it begins.
 *
 * @param {any[]} values SI
 * @param {Unit | null} unit
 * @returns {string[]}
 */
export function inputTexts(values, unit) {
  const texts = values.map((value) => inputText(value, unit));
  const first = values[0];
  return texts.map((text, index) => {
    const value = values[index];
    if (text !== texts[0] || !Array.isArray(value) || !Array.isArray(first)) return text;
    const rows = value.flatMap((item, row) => (item === first[row] ? [] : [row]));
    if (!rows.length) return text;
    const others = rows.length > 1 ? `, ${rows.length - 1} more` : "";
    return `${text}; row ${rows[0] + 1}: ${inputText(value[rows[0]], unit)}${others}`;
  });
}

/**
 * How much a result changed against the baseline.
 *
 * @param {number | null} change relative [1]
 * @returns {string} empty where there is nothing to say
 */
export function changeText(change) {
  if (change === null || change === undefined || !Number.isFinite(change)) return "";
  if (Math.abs(change) < NONE) return "same";
  const sign = change > 0 ? "+" : "−";
  const size = Math.abs(change);
  if (size >= MANY) return `${sign}${number(size, 2)} times`;
  return `${sign}${number(size * 100, size < 0.1 ? 2 : 3)} %`;
}

/**
 * A result's value in its display unit.
 *
 * @param {number | null} value SI
 * @param {Unit | null} unit
 */
export const resultText = (value, unit) => number(value === null ? null : value * (unit?.scale ?? 1), 4);

/** Groups in the order of the page, and whether they lie open. @type {[string, string, boolean][]} */
const GROUPS = [
  ["verdict", "Verdicts", true],
  ["comfort", "Passenger comfort", true],
  ["modes", "Natural frequencies", true],
  ["deck", "Deck", true],
  ["contact", "Contact forces", false],
  ["wheel", "Wheels", false],
  ["vehicle", "Vehicles", false],
  ["cost", "Cost", false],
];

/**
 * Results by group; what nobody named comes last, and after it what only one run has.
 *
 * @param {ComparedResult[]} results
 * @returns {{ title: string, open: boolean, results: ComparedResult[] }[]}
 */
export function resultGroups(results) {
  const alone = (/** @type {ComparedResult} */ result) => result.group !== "verdict" && result.values.filter((value) => value !== null).length < 2;
  const lonely = results.filter(alone);
  const groups = sharedGroups(results.filter((result) => !alone(result)));
  return lonely.length ? [...groups, { title: "What only one run has", open: false, results: lonely }] : groups;
}

/** @param {ComparedResult[]} results */
function sharedGroups(results) {
  const known = GROUPS.map(([name]) => name);
  const others = [...new Set(results.map((result) => result.group))].filter((name) => !known.includes(name));
  return [...GROUPS, .../** @type {[string, string, boolean][]} */ (others.map((name) => [name, words(name), false]))]
    .map(([name, title, open]) => ({ title, open, results: results.filter((result) => result.group === name) }))
    .filter((group) => group.results.length);
}

/**
 * The history that is laid over one another first: what a verdict looks at.
 *
 * @param {{ name: string, group: string }[]} channels
 * @param {string | null} asked
 */
export function chosenChannel(channels, asked) {
  const names = channels.map((channel) => channel.name);
  if (asked && names.includes(asked)) return asked;
  const deck = names.filter((name) => name.endsWith("/acceleration") && name.startsWith("mid-span"));
  return deck.find((name) => name.startsWith("mid-span 2, axis")) ?? deck[0] ?? names[0] ?? "";
}
