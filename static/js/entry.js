// @ts-check
/** What is typed and what is stored: display units outside, SI inside. Pure. */
import { number, unitText } from "./format.js";
import { condensed, counted, expanded, named } from "./ranges.js";

/** @typedef {import("./schema.js").Field} Field */
/** @typedef {{ value: any, error?: undefined } | { error: string, value?: undefined }} Entry */

/** Twelve figures survive the change of units both ways without the noise of the sixteenth. */
const FIGURES = 12;

/** @param {number} value */
const tidy = (value) => Number(value.toPrecision(FIGURES));

/**
 * The text of a stored value.
 *
 * @param {any} value
 * @param {Field} field
 * @returns {string}
 */
export function shown(value, field) {
  if (value === null || value === undefined) return "";
  if (field.kind === "texts") return counted(value);
  if (Array.isArray(value)) return condensed(value.map((item) => Number(item) * scaleOf(field)));
  if (typeof value !== "number" || field.whole) return String(value);
  return String(tidy(value * (field.unit?.scale ?? 1)));
}

/**
 * The value of a text, or what is wrong with it; bounds are checked at once, everything else by
 * the server.
 *
 * @param {string} text
 * @param {Field} field
 * @returns {Entry}
 */
export function entered(text, field) {
  if (field.optional && text.trim() === "") return { value: null };
  if (field.kind === "text" || field.kind === "choice") return { value: text };
  if (field.kind === "texts") return names(text, field);
  const bare = withoutUnit(text, field);
  return field.kind === "list" ? list(bare, field) : one(bare, field);
}

/**
 * The text without the unit that stands beside the input anyway.
 *
 * @param {string} text
 * @param {Field} field
 */
function withoutUnit(text, { unit }) {
  const own = [unitText(unit), unit?.display || unit?.symbol || ""].filter((name) => name && name !== "1");
  const typed = text.trim();
  const found = own.find((name) => typed.endsWith(name));
  return found ? typed.slice(0, -found.length) : text;
}

/**
 * Several names between commas; "16 × name" is sixteen of them.
 *
 * @param {string} text
 * @param {Field} field
 * @returns {Entry}
 */
function names(text, field) {
  const value = named(text);
  if (!value.length) return { error: "Give a name, or several between commas." };
  return tooMany(value.length, field) ?? { value };
}

/**
 * @param {number} count
 * @param {Field} field
 */
function tooMany(count, { most }) {
  return most !== null && count > most ? { error: `These are ${count} values; give at most ${most}.` } : null;
}

/**
 * Several numbers or ranges between commas, semicolons or spaces; decimals with a point, between
 * semicolons with a comma too.
 *
 * @param {string} text
 * @param {Field} field
 * @returns {Entry}
 */
function list(text, field) {
  const parts = text
    .replace(/\s*:\s*/g, ":")
    .split(text.includes(";") ? /[;\s]+/ : /[,\s]+/)
    .filter(Boolean);
  if (!parts.length) return { error: "Give a number, or several between commas." };
  /** @type {string[]} */
  const single = [];
  for (const part of parts) {
    const found = part.includes(":") ? expanded(part) : null;
    if (found?.error !== undefined) return { error: `${part}: ${found.error}` };
    single.push(...(found?.values.map(String) ?? [part]));
  }
  const many = tooMany(single.length, field);
  if (many) return many;
  const entries = single.map((part) => one(part, field));
  const wrong = entries.findIndex((entry) => entry.error);
  if (wrong < 0) return { value: entries.map((entry) => entry.value) };
  return { error: single.length > 1 ? `${single[wrong]}: ${entries[wrong].error}` : `${entries[0].error}` };
}

/**
 * @param {string} text
 * @param {Field} field
 * @returns {Entry}
 */
function one(text, field) {
  const typed = text.trim().replace(",", ".").replace("−", "-");
  const value = typed === "" ? Number.NaN : Number(typed);
  if (!Number.isFinite(value)) return { error: "Give a number, for example 0.25." };
  if (field.whole && !Number.isInteger(value)) return { error: "Give a whole number." };
  const stored = field.whole ? value : tidy(value / (field.unit?.scale ?? 1));
  const error = outside(stored, field);
  return error ? { error } : { value: stored };
}

/**
 * @param {number} value
 * @param {Field} field
 */
function outside(value, field) {
  const { minimum, maximum, above, below } = field;
  if (minimum !== null && (above ? value <= minimum : value < minimum)) {
    return `Must be ${above ? "greater than" : "at least"} ${bound(minimum, field)}.`;
  }
  if (maximum !== null && (below ? value >= maximum : value > maximum)) {
    return `Must be ${below ? "less than" : "at most"} ${bound(maximum, field)}.`;
  }
  return "";
}

/**
 * @param {number} value
 * @param {Field} field
 */
function bound(value, field) {
  return `${round(value, field)} ${unitText(field.unit)}`.trim();
}

/**
 * A bound without zeros that say nothing.
 *
 * @param {number} value
 * @param {Field} field
 */
function round(value, field) {
  return number(tidy(value * scaleOf(field)), 6).replace(/\.?0+e/, "e");
}

/** @param {Field} field */
const scaleOf = (field) => (field.whole ? 1 : (field.unit?.scale ?? 1));

/**
 * The allowed range in words, empty where there is none.
 *
 * @param {Field} field
 */
export function range(field) {
  const { minimum, maximum } = field;
  if (minimum === null && maximum === null) return "";
  const low = minimum === null ? "" : `${field.above ? "more than" : "from"} ${bound(minimum, field)}`;
  const high = maximum === null ? "" : `${field.below ? "less than" : "up to"} ${bound(maximum, field)}`;
  if (!low || !high) return low || high;
  const plain = round(/** @type {number} */ (minimum), field);
  return field.above || field.below
    ? `${field.above ? "more than" : "from"} ${plain}, ${high}`
    : `${plain} to ${bound(/** @type {number} */ (maximum), field)}`;
}
