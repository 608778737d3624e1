// @ts-check
/** The kinds of the library, and a study around a part, for drawing and editing. Pure. */

/** @typedef {import("./types.js").Template} Template */
/** @typedef {import("./types.js").LibraryItem} Item */
/** @typedef {import("./types.js").LibraryEntry} Entry */

/** @type {{ kind: string, part: string, title: string, one: string }[]} */
export const KINDS = [
  { kind: "trains", part: "train", title: "Trains", one: "train" },
  { kind: "viaducts", part: "viaduct", title: "Viaducts", one: "viaduct" },
  { kind: "tracks", part: "track", title: "Tracks", one: "track" },
  { kind: "irregularities", part: "irregularity", title: "Irregularities", one: "irregularity" },
];

/** @param {string} kind */
export const kindOf = (kind) => KINDS.find((item) => item.kind === kind) ?? null;

/** Parts that belong to plain beams. */
const PLAIN = new Set(["sprung_masses", "beam", "none"]);

/**
 * A study that holds a part, its other parts those of the first template that goes with it.
 *
 * @param {string} part name of the study's field
 * @param {any} value
 * @param {Template[]} templates
 * @returns {import("./types.js").Study}
 */
export function studyAround(part, value, templates) {
  const plain = part !== "irregularity" && PLAIN.has(value?.type);
  const fits = (/** @type {Template} */ item) => (item.study.viaduct?.type === "beam") === plain;
  const base = templates.find(fits) ?? templates[0];
  const perfect = part === "irregularity" ? {} : { irregularity: { type: "none" } };
  return { ...(base?.study ?? {}), ...perfect, [part]: value };
}

/**
 * What is sent to keep an entry; remarks on figures that were changed since are dropped, for they
 * spoke of what the source has.
 *
 * @param {Entry} entry
 * @param {any} before the value of which the remarks speak
 * @returns {Entry}
 */
export function entryOf({ name, source, confidence, remarks, value }, before) {
  const kept = remarks.filter(({ pointer }) => JSON.stringify(valueAt(value, pointer)) === JSON.stringify(valueAt(before, pointer)));
  return { name, source, confidence, remarks: kept, value };
}

/**
 * @param {any} value
 * @param {string} pointer
 */
function valueAt(value, pointer) {
  return pointer.split("/").slice(1).reduce((part, key) => part?.[key], value);
}

/**
 * A copy under another name.
 *
 * @param {Item} item
 * @returns {Entry}
 */
export function copyOf(item) {
  const source = item.source && !item.source.startsWith("Copy of ") ? `Copy of ${item.name}: ${item.source}` : item.source;
  return entryOf({ ...item, name: `${item.name} (copy)`.slice(0, 120), source: source.slice(0, 1000) }, item.value);
}

/**
 * The text of a file as something to import: a library, a list of entries, or one entry.
 *
 * @param {string} text
 * @returns {{ items: unknown[] }}
 * @throws {Error} in words, where it is none of these
 */
export function importable(text) {
  let read;
  try {
    read = JSON.parse(text);
  } catch (error) {
    throw new Error(`The file is no JSON: ${/** @type {Error} */ (error).message}.`);
  }
  const items = Array.isArray(read) ? read : Array.isArray(read?.items) ? read.items : [read];
  const strange = items.findIndex((/** @type {any} */ item) => !item || typeof item !== "object" || !("value" in item) || !("kind" in item));
  if (strange < 0 && items.length) return { items };
  throw new Error("The file holds no entries of a library: each needs a kind, a name and a value, as an export has them.");
}
