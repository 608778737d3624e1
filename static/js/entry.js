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
 */
export function shown(value, field) {
  if (value === null || value === undefined) return "";
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
  const typed = text.trim().replace(",", ".").replace("−", "-");
  const value = typed === "" ? Number.NaN : Number(typed);
  if (!Number.isFinite(value)) return { error: "Give a number." };
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
  const scale = field.kind === "integer" ? 1 : (field.unit?.scale ?? 1);
  return `${number(tidy(value * scale), 6)} ${unitText(field.unit)}`.trim();
}

/**
 * The allowed range in words, empty where there is none.
 *
 * @param {Field} field
 */
export function range(field) {
  const { minimum, maximum } = field;
  if (minimum === null && maximum === null) return "";
  if (maximum === null) return `from ${bound(/** @type {number} */ (minimum), field)}`;
  if (minimum === null) return `up to ${bound(maximum, field)}`;
  return `${bound(minimum, field)} to ${bound(maximum, field)}`;
}
