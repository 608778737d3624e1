// @ts-check
/**
 * A form from a JSON schema: which inputs a study has, their units, bounds and help. Pure.
 *
 * The schema is the solver's own declaration, sent by the server; nothing about a field is written
 * here a second time. Values are SI; a field shows its display unit.
 */
import { at } from "./pointer.js";
import { words } from "./titles.js";

/** @typedef {import("./types.js").Unit} Unit */
/** @typedef {Record<string, any>} Schema */
/**
 * @typedef {object} Field
 * @property {string} pointer JSON pointer into the study
 * @property {"number" | "integer" | "text" | "choice" | "switch" | "list" | "texts"} kind
 *   a list holds numbers, texts hold names
 * @property {string} label
 * @property {string} help
 * @property {Unit | null} unit
 * @property {number | null} minimum SI
 * @property {number | null} maximum SI
 * @property {boolean} above the minimum itself is not allowed
 * @property {boolean} below the maximum itself is not allowed
 * @property {string[]} options of a choice
 * @property {number | null} most values of a list
 * @property {boolean} whole only whole numbers
 * @property {boolean} optional nothing at all is a value too
 * @property {any} standard what it is where a study leaves it out
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

/**
 * The property that tells an alternative from the others: `type`, else the first fixed word.
 *
 * @param {Schema} schema
 * @returns {string}
 */
export function tagKey(schema) {
  const fixed = Object.entries(schema.properties ?? {}).filter(([, part]) => typeof fixedWord(part) === "string");
  return (fixed.find(([key]) => key === "type") ?? fixed[0])?.[0] ?? "";
}

/** @param {Schema} part */
const fixedWord = (part) => part.const ?? (part.enum?.length === 1 ? part.enum[0] : undefined);

/** @param {Schema} schema */
function tagOf(schema) {
  return fixedWord(schema.properties?.[tagKey(schema)] ?? {}) ?? "";
}

/**
 * Whether a place may hold nothing at all.
 *
 * @param {Schema} schema
 * @param {Schema} document
 */
export function optional(schema, document) {
  const parts = resolve(schema, document).anyOf ?? [];
  return parts.some((/** @type {Schema} */ part) => part.type === "null");
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
  const tagged = variants(resolved, document).find((item) => item.tag === value?.[tagKey(item.schema)]);
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
  if (resolved.oneOf || resolved.anyOf) {
    return optional(resolved, document) ? null : defaults(variants(resolved, document)[0]?.schema ?? {}, document);
  }
  if (resolved.enum) return resolved.enum[0];
  if (resolved.type === "array") return [];
  return resolved.type === "string" ? "" : 0;
}

/**
 * A value with everything that it leaves out filled in, as the server reads it.
 *
 * @param {Schema} schema
 * @param {any} value
 * @param {Schema} document
 * @returns {any}
 */
export function completed(schema, value, document) {
  const part = chosen(schema, value, document);
  if (Array.isArray(value)) {
    return value.map((item, index) => completed(part.prefixItems?.[index] ?? part.items ?? {}, item, document));
  }
  if (!value || typeof value !== "object" || !part.properties) return value;
  const missing = Object.entries(part.properties)
    .filter(([key]) => !(key in value) && !part.required?.includes(key))
    .map(([key, child]) => [key, defaults(child, document)]);
  const present = Object.entries(value).map(([key, item]) => [key, completed(part.properties[key] ?? {}, item, document)]);
  const all = Object.fromEntries([...present, ...missing]);
  const order = [...Object.keys(part.properties), ...Object.keys(value)].filter((key) => key in all);
  return Object.fromEntries(order.map((key) => [key, all[key]]));
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
  const kind = kindOf(part, document);
  if (!kind || "const" in part) return null;
  const item = kind === "list" ? resolve(part.items ?? part.prefixItems?.[0], document) : part;
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
    whole: item.type === "integer",
    optional: optional(schema, document),
    standard: part.default,
  };
}

/**
 * @param {Schema} part
 * @param {Schema} document
 * @returns {Field["kind"] | null}
 */
function kindOf(part, document) {
  if (part.enum) return "choice";
  if (part.type === "array") return listKind(part, document);
  /** @type {Record<string, Field["kind"]>} */
  const kinds = { number: "number", integer: "integer", string: "text", boolean: "switch" };
  return kinds[part.type] ?? null;
}

/**
 * @param {Schema} part
 * @param {Schema} document
 * @returns {Field["kind"] | null}
 */
function listKind(part, document) {
  const items = (part.prefixItems ?? [part.items ?? {}]).map((/** @type {Schema} */ item) => resolve(item, document));
  if (items.every((/** @type {Schema} */ item) => item.type === "number" || item.type === "integer")) return "list";
  return items.every((/** @type {Schema} */ item) => item.type === "string") ? "texts" : null;
}

/**
 * What a place is called: the last part of its pointer in words.
 *
 * @param {string} pointer
 */
export function nameOf(pointer) {
  const parts = pointer.split("/");
  const last = parts[parts.length - 1];
  return /^\d+$/.test(last)
    ? `${words(parts[parts.length - 2]).replace(/s$/, "")} ${Number(last) + 1}`
    : words(last);
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
