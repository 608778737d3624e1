// @ts-check
/** What a form draws for a place of a study: fields, groups, choices, tables. Pure. */
import { keyed } from "./pointer.js";
import { chosen, defaults, field, fieldsUnder, nameOf, optional, resolve, tagKey, variants } from "./schema.js";

/** @typedef {import("./schema.js").Schema} Schema */
/** @typedef {import("./schema.js").Field} Field */
/** @typedef {{ type: "field", pointer: string, field: Field }} FieldNode */
/** @typedef {{ type: "group", pointer: string, title: string, help: string, children: Node[] }} GroupNode */
/** @typedef {{ tag: string, help: string, initial: any, complete: boolean }} Option complete: its defaults can be run */
/**
 * @typedef {{ type: "choice", pointer: string, title: string, help: string, tagPointer: string, options: Option[],
 *   chosen: string, children: Node[] }} ChoiceNode
 * @typedef {{ type: "table", pointer: string, title: string, help: string, columns: Field[], count: number,
 *   least: number, most: number, blank: any }} TableNode
 *   columns are fields whose pointers begin at a row
 * @typedef {{ type: "items", pointer: string, title: string, help: string, children: Node[], most: number,
 *   blank: any }} ItemsNode
 */
/** @typedef {FieldNode | GroupNode | ChoiceNode | TableNode | ItemsNode} Node */

/** The tag of an optional part that is left out. */
export const NOTHING = "";
/** Rows of a list that states no bound. */
const UNBOUND = 10_000;
/** Columns of a table of numbers that says not how many it has. */
const PAIR = 2;

/**
 * The node of one place, null where there is nothing to type.
 *
 * @param {Schema} schema
 * @param {any} value
 * @param {string} pointer
 * @param {Schema} document
 * @returns {Node | null}
 */
export function planOf(schema, value, pointer, document) {
  const single = field(schema, value, pointer, document);
  if (single) return { type: "field", pointer, field: single };
  const resolved = resolve(schema, document);
  const part = chosen(schema, value, document);
  const about = { pointer, title: nameOf(pointer), help: resolved.description ?? part.description ?? "" };
  const tags = variants(resolved, document);
  if (tags.length > 1 || (tags.length && optional(resolved, document))) return choice(tags, resolved, value, about, document);
  if (part.type === "array") return listed(part, value, about, document);
  if (!part.properties) return null;
  return { type: "group", ...about, children: childrenOf(part, value, pointer, document) };
}

/** @typedef {{ pointer: string, title: string, help: string }} About */

/**
 * @param {Schema} part
 * @param {any} value
 * @param {string} pointer
 * @param {Schema} document
 * @returns {Node[]}
 */
function childrenOf(part, value, pointer, document) {
  return Object.entries(part.properties ?? {})
    .map(([key, child]) => planOf(child, value?.[key], keyed(pointer, key), document))
    .filter((node) => node !== null);
}

/**
 * @param {{ tag: string, schema: Schema }[]} tags
 * @param {Schema} schema
 * @param {any} value
 * @param {About} about
 * @param {Schema} document
 * @returns {ChoiceNode}
 */
function choice(tags, schema, value, about, document) {
  const key = tagKey(tags[0].schema);
  const tag = value === null || value === undefined ? NOTHING : value[key];
  const options = tags.map((item) => ({
    tag: item.tag,
    help: item.schema.description ?? "",
    initial: { ...defaults(item.schema, document), [key]: item.tag },
    complete: !item.schema.required?.length,
  }));
  const none = optional(schema, document) ? [{ tag: NOTHING, help: "", initial: null, complete: true }] : [];
  const own = tags.find((item) => item.tag === tag)?.schema ?? {};
  return {
    type: "choice",
    ...about,
    tagPointer: keyed(about.pointer, key),
    options: [...none, ...options],
    chosen: tag,
    children: childrenOf(own, value, about.pointer, document),
  };
}

/**
 * @param {Schema} part
 * @param {any} value
 * @param {About} about
 * @param {Schema} document
 * @returns {TableNode | ItemsNode}
 */
function listed(part, value, about, document) {
  const rows = Array.isArray(value) ? value : [];
  const item = resolve(part.items ?? {}, document);
  const blank = item.type === "array" ? blankRow(item, rows, document) : (rows[rows.length - 1] ?? defaults(item, document));
  const bounds = { least: part.minItems ?? 0, most: part.maxItems ?? UNBOUND, blank };
  if (variants(item, document).length > 1) {
    const children = rows.map((row, index) => planOf(item, row, keyed(about.pointer, index), document)).filter((node) => node !== null);
    return { type: "items", ...about, children, ...bounds };
  }
  const columns = item.type === "array" ? cells(item, blank, document) : fieldsUnder(item, blank, "", document);
  return { type: "table", ...about, columns, count: rows.length, ...bounds };
}

/**
 * @param {Schema} item
 * @param {any[]} rows
 * @param {Schema} document
 */
function blankRow(item, rows, document) {
  const parts = item.prefixItems ?? Array(item.maxItems ?? rows[0]?.length ?? PAIR).fill(item.items ?? {});
  return rows[rows.length - 1] ?? parts.map((/** @type {Schema} */ part) => defaults(part, document));
}

/**
 * The columns of rows that are lists of numbers.
 *
 * @param {Schema} item
 * @param {any[]} blank
 * @param {Schema} document
 * @returns {Field[]}
 */
function cells(item, blank, document) {
  return blank.flatMap((value, index) => {
    const own = item.prefixItems?.[index] ?? item.items ?? {};
    const cell = field(own, value, `/${index}`, document);
    return cell ? [{ ...cell, label: resolve(own, document).title ?? `Column ${index + 1}` }] : [];
  });
}

/**
 * Every place of a plan that can hold a finding, in the order of the page.
 *
 * @param {Node} node
 * @returns {string[]}
 */
export function pointersOf(node) {
  if (node.type === "field") return [node.pointer];
  if (node.type === "table") return [node.pointer];
  const own = node.type === "choice" ? [node.pointer] : [];
  return [...own, ...node.children.flatMap(pointersOf)];
}
