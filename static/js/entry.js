// @ts-check
/** What is typed and what is stored: display units outside, SI inside. Pure. */
import { number, unitText } from "./format.js";

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
  if (Array.isArray(value)) return value.map((item) => shown(item, field)).join(", ");
  if (typeof value !== "number" || field.kind === "integer") return String(value);
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
  if (field.kind === "text" || field.kind === "choice") return { value: text };
  return field.kind === "list" ? list(text, field) : one(text, field);
}

/**
 * Several numbers between commas, semicolons or spaces; decimals with a point.
 *
 * @param {string} text
 * @param {Field} field
 * @returns {Entry}
 */
function list(text, field) {
  const parts = text.split(/[,;\s]+/).filter(Boolean);
  if (!parts.length) return { error: "Give a number, or several between commas." };
  if (field.most !== null && parts.length > field.most) {
    return { error: `These are ${parts.length} values; give at most ${field.most}.` };
  }
  const entries = parts.map((part) => one(part, field));
  const wrong = entries.findIndex((entry) => entry.error);
  if (wrong < 0) return { value: entries.map((entry) => entry.value) };
  return { error: parts.length > 1 ? `${parts[wrong]}: ${entries[wrong].error}` : `${entries[0].error}` };
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
  if (field.kind === "integer" && !Number.isInteger(value)) return { error: "Give a whole number." };
  const stored = field.kind === "integer" ? value : tidy(value / (field.unit?.scale ?? 1));
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
  return `${number(tidy(value * scaleOf(field)), 6)} ${unitText(field.unit)}`.trim();
}

/** @param {Field} field */
const scaleOf = (field) => (field.kind === "integer" ? 1 : (field.unit?.scale ?? 1));

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
  const plain = number(tidy(/** @type {number} */ (minimum) * scaleOf(field)), 6);
  return field.above || field.below
    ? `${field.above ? "more than" : "from"} ${plain}, ${high}`
    : `${plain} to ${bound(/** @type {number} */ (maximum), field)}`;
}
