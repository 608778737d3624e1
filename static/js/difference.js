// @ts-check
/** Where two plain values differ. Pure. */
import { keyed } from "./pointer.js";

/**
 * Whether two plain values say the same; the order of an object's keys does not matter.
 *
 * @param {any} one
 * @param {any} other
 * @returns {boolean}
 */
export function same(one, other) {
  if (one === other) return true;
  if (typeof one !== "object" || typeof other !== "object" || !one || !other) return false;
  if (Array.isArray(one) !== Array.isArray(other)) return false;
  const keys = Object.keys(one);
  return (
    keys.length === Object.keys(other).length &&
    keys.every((key) => Object.hasOwn(other, key) && same(one[key], other[key]))
  );
}

/**
 * Pointers of what differs: as deep as both values have the same shape; a list of another length,
 * a list of plain values and another alternative of a union count as one.
 *
 * @param {any} before
 * @param {any} after
 * @param {string} [pointer]
 * @returns {string[]}
 */
export function differences(before, after, pointer = "") {
  if (same(before, after)) return [];
  if (!comparable(before, after)) return [pointer];
  const keys = [...new Set([...Object.keys(before), ...Object.keys(after)])];
  return keys.flatMap((key) => differences(before[key], after[key], keyed(pointer, key)));
}

/**
 * @param {any} before
 * @param {any} after
 */
function comparable(before, after) {
  if (!before || !after || typeof before !== "object" || typeof after !== "object") return false;
  if (Array.isArray(before) !== Array.isArray(after)) return false;
  if (Array.isArray(before)) {
    const nested = [...before, ...after].some((item) => item !== null && typeof item === "object");
    return nested && before.length === after.length;
  }
  return before.type === after.type;
}
