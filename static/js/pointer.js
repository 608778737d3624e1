// @ts-check
/** JSON pointers (RFC 6901) into plain values; a change makes a new value. Pure. */

/**
 * The value at a pointer, undefined where there is none.
 *
 * @param {any} value
 * @param {string} pointer
 * @returns {any}
 */
export function at(value, pointer) {
  return keys(pointer).reduce((part, key) => (part === null ? undefined : part?.[key]), value);
}

/**
 * A copy with another value at a pointer; everything beside the way is shared.
 *
 * @template T
 * @param {T} value
 * @param {string} pointer
 * @param {any} changed
 * @returns {T}
 */
export function withValue(value, pointer, changed) {
  const [key, ...rest] = keys(pointer);
  if (key === undefined) return changed;
  const copy = /** @type {any} */ (Array.isArray(value) ? [...value] : { ...value });
  copy[key] = withValue(copy[key], rest.map((part) => `/${escape(part)}`).join(""), changed);
  return copy;
}

/** @param {string} pointer */
function keys(pointer) {
  return pointer
    .split("/")
    .slice(1)
    .map((key) => key.replace(/~1/g, "/").replace(/~0/g, "~"));
}

/**
 * The pointer of a key inside a place.
 *
 * @param {string} pointer
 * @param {string | number} key
 */
export function keyed(pointer, key) {
  return `${pointer}/${escape(String(key))}`;
}

/** @param {string} key */
const escape = (key) => key.replace(/~/g, "~0").replace(/\//g, "~1");

/**
 * The field at which a finding is shown: its own, else the nearest one inside or around it.
 *
 * @param {string} pointer of the finding; a leading /study is the envelope's
 * @param {string[]} fields pointers of the form's fields
 * @returns {string | null}
 */
export function nearest(pointer, fields) {
  const own = pointer.replace(/^\/study(?=\/|$)/, "");
  if (fields.includes(own)) return own;
  const inside = fields.find((field) => field.startsWith(`${own}/`));
  if (own && inside) return inside;
  const around = fields.filter((field) => own.startsWith(`${field}/`));
  return around.sort((a, b) => b.length - a.length)[0] ?? null;
}
