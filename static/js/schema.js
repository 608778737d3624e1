// @ts-check
/**
 * A form from a JSON schema: which inputs a study has, their units, bounds and help. Pure.
 *
 * The schema is the solver's own declaration, sent by the server; nothing about a field is written
 * here a second time. Values are SI; a field shows its display unit.
 */
import { label } from "./format.js";
import { at } from "./pointer.js";

/** @typedef {import("./types.js").Unit} Unit */
/** @typedef {Record<string, any>} Schema */
/**
 * @typedef {object} Field
 * @property {string} pointer JSON pointer into the study
 * @property {"number" | "integer" | "text" | "choice" | "switch" | "list"} kind
 * @property {string} label
 * @property {string} help
 * @property {Unit | null} unit
 * @property {number | null} minimum SI
 * @property {number | null} maximum SI
 * @property {boolean} above the minimum itself is not allowed
 * @property {boolean} below the maximum itself is not allowed
 * @property {string[]} options of a choice
 * @property {number | null} most values of a list
 */

/**
 * A schema with its references followed; words beside a reference win.
 *
 * @param {Schema} schema
 * @param {Schema} document
 * @returns {Schema}
 */
export function resolve(schema, document) {
  if (!schema?.$ref) return schema ?? {};
  const { $ref, ...beside } = schema;
  const target = at(document, $ref.replace(/^#/, "")) ?? {};
  return { ...resolve(target, document), ...beside };
}

/**
 * The alternatives of a union, each with the tag that names it.
 *
 * @param {Schema} schema
 * @param {Schema} document
 * @returns {{ tag: string, schema: Schema }[]}
 */
export function variants(schema, document) {
  const resolved = resolve(schema, document);
  const parts = resolved.oneOf ?? resolved.anyOf;
  if (!parts) {
    const own = tagOf(resolved);
    return own ? [{ tag: own, schema: resolved }] : [];
  }
  return parts
    .map((/** @type {Schema} */ part) => resolve(part, document))
    .filter((/** @type {Schema} */ part) => tagOf(part))
    .map((/** @type {Schema} */ part) => ({ tag: tagOf(part), schema: part }));
}

/** @param {Schema} schema */
function tagOf(schema) {
  const type = schema.properties?.type;
  return type?.const ?? (type?.enum?.length === 1 ? type.enum[0] : "");
}

/**
 * The schema of the alternative that a value is.
 *
 * @param {Schema} schema
 * @param {any} value
 * @param {Schema} document
 * @returns {Schema}
 */
export function chosen(schema, value, document) {
  const resolved = resolve(schema, document);
  if (!resolved.oneOf && !resolved.anyOf) return resolved;
  const tagged = variants(resolved, document).find((item) => item.tag === value?.type);
  if (tagged) return tagged.schema;
  const parts = (resolved.oneOf ?? resolved.anyOf).map((/** @type {Schema} */ part) =>
    resolve(part, document),
  );
  const plain = parts.find((/** @type {Schema} */ part) => part.type !== "null") ?? {};
  return { ...plain, ...without(resolved, ["oneOf", "anyOf"]) };
}

/**
 * @param {Schema} schema
 * @param {string[]} keys
 */
function without(schema, keys) {
  return Object.fromEntries(Object.entries(schema).filter(([key]) => !keys.includes(key)));
}

/**
 * What an alternative holds when it is chosen: its defaults.
 *
 * @param {Schema} schema
 * @param {Schema} document
 * @returns {any}
 */
export function defaults(schema, document) {
  const resolved = resolve(schema, document);
  if ("default" in resolved) return resolved.default;
  if ("const" in resolved) return resolved.const;
  if (resolved.properties) {
    return Object.fromEntries(
      Object.entries(resolved.properties).map(([key, part]) => [key, defaults(part, document)]),
    );
  }
  if (resolved.enum) return resolved.enum[0];
  if (resolved.type === "array") return [];
  return resolved.type === "string" ? "" : 0;
}

/**
 * The schema of one place in a study, following the alternatives that the study chose.
 *
 * @param {Schema} schema of the whole study
 * @param {any} study
 * @param {string} pointer
 * @param {Schema} document
 * @returns {Schema | null}
 */
export function schemaAt(schema, study, pointer, document) {
  /** @type {Schema | null} */
  let part = schema;
  let value = study;
  for (const key of pointer.split("/").slice(1)) {
    const here = chosen(/** @type {Schema} */ (part), value, document);
    const next = here.properties?.[key] ?? here.prefixItems?.[Number(key)] ?? here.items ?? null;
    if (!next) return null;
    part = next;
    value = value?.[key];
  }
  return part;
}

/**
 * One field of the form, or null where a place is no plain value.
 *
 * @param {Schema} schema of this place
 * @param {any} value
 * @param {string} pointer
 * @param {Schema} document
 * @returns {Field | null}
 */
export function field(schema, value, pointer, document) {
  const part = chosen(schema, value, document);
  const kind = kindOf(part);
  if (!kind || "const" in part) return null;
  const item = kind === "list" ? resolve(part.items, document) : part;
  return {
    pointer,
    kind,
    label: nameOf(pointer),
    help: part.description ?? "",
    unit: item.unit ?? null,
    minimum: item.minimum ?? item.exclusiveMinimum ?? null,
    maximum: item.maximum ?? item.exclusiveMaximum ?? null,
    above: item.exclusiveMinimum !== undefined,
    below: item.exclusiveMaximum !== undefined,
    options: part.enum ?? [],
    most: part.maxItems ?? null,
  };
}

/**
 * @param {Schema} part
 * @returns {Field["kind"] | null}
 */
function kindOf(part) {
  if (part.enum) return "choice";
  if (part.type === "array" && part.items?.type === "number") return "list";
  /** @type {Record<string, Field["kind"]>} */
  const kinds = { number: "number", integer: "integer", string: "text", boolean: "switch" };
  return kinds[part.type] ?? null;
}

/** @param {string} pointer */
function nameOf(pointer) {
  const parts = pointer.split("/");
  const last = parts[parts.length - 1];
  return /^\d+$/.test(last)
    ? `${label(parts[parts.length - 2]).replace(/s$/, "")} ${Number(last) + 1}`
    : label(last);
}

/**
 * Every plain field under a place, in the schema's order.
 *
 * @param {Schema} schema
 * @param {any} value
 * @param {string} pointer
 * @param {Schema} document
 * @returns {Field[]}
 */
export function fieldsUnder(schema, value, pointer, document) {
  const single = field(schema, value, pointer, document);
  if (single) return [single];
  const part = chosen(schema, value, document);
  if (Array.isArray(value)) {
    return value.flatMap((item, index) =>
      fieldsUnder(part.prefixItems?.[index] ?? part.items ?? {}, item, `${pointer}/${index}`, document),
    );
  }
  return Object.entries(part.properties ?? {}).flatMap(([key, child]) =>
    fieldsUnder(child, value?.[key], `${pointer}/${key}`, document),
  );
}
