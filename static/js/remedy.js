// @ts-check
/** The value that a finding's advice names, so that one click can follow it. Pure. */

/** @typedef {import("./types.js").Finding} Finding */
/** @typedef {import("./schema.js").Field} Field */

const NUMBER = /\b(?:use|give|place it (?:at|before))\s+(?:at (?:most|least)\s+|x = )?(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)\s*(\S*?)[.,]?(?:\s|$)/i;

/**
 * The value to use, SI, or null where the advice names none that the field can take.
 *
 * @param {Finding} finding
 * @param {Field} field
 * @returns {number | string | null}
 */
export function advised({ remedy = "" }, field) {
  if (field.kind === "choice") {
    const words = remedy.toLowerCase().match(/\w+/g) ?? [];
    return words.find((word) => field.options.includes(word)) ?? null;
  }
  if (field.kind !== "number" && field.kind !== "integer") return null;
  const [, digits, symbol] = NUMBER.exec(remedy) ?? [];
  if (digits === undefined) return null;
  const value = stored(Number(digits), symbol, field);
  return value !== null && inside(value, field) ? value : null;
}

/**
 * @param {number} value
 * @param {string} symbol
 * @param {Field} field
 */
function stored(value, symbol, { unit, kind }) {
  const own = unit?.symbol ?? "1";
  if (symbol === own || own === "1" || !/^[a-zµ]/i.test(symbol)) return kind === "integer" && !Number.isInteger(value) ? null : value;
  if (unit && symbol === unit.display) return Number((value / unit.scale).toPrecision(12));
  return null;
}

/**
 * @param {number} value
 * @param {Field} field
 */
function inside(value, { minimum, maximum, above, below }) {
  const low = minimum === null || (above ? value > minimum : value >= minimum);
  return low && (maximum === null || (below ? value < maximum : value <= maximum));
}
