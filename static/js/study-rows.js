// @ts-check
/** A study as lines to read: name, value, unit, and what the template has where that differs. Pure. */
import { differences } from "./difference.js";
import { shown } from "./entry.js";
import { unitText } from "./format.js";
import { at } from "./pointer.js";
import { abridged } from "./ranges.js";
import { completed, fieldsUnder } from "./schema.js";
import { sectionsOf } from "./sections.js";
import { titleOf, words } from "./titles.js";

/** @typedef {import("./types.js").Study} Study */
/** @typedef {import("./types.js").Template} Template */
/** @typedef {import("./schema.js").Field & { column?: { table: string, key: string } }} Field column: it stands for all cells of one */
/**
 * @typedef {{ pointer: string, label: string, text: string, unit: string, standard: string | null, standardUnit: string }} Row
 *   `standard` is the template's value where it is another one
 * @typedef {{ title: string, rows: Row[] }} Group
 * @typedef {{ title: string, groups: Group[] }} Section
 */

/** From this many rows on, a table of numbers is read column by column. */
const LONG = 4;
/** What 0 stands for, by the pointer of a field, or of a column whose cells are all 0. @type {Record<string, string>} */
const WHERE_ZERO = {
  "/approach/length": "follows from the train",
  "/approach/bed_stiffness": "matched to the track's deflection",
  "/outputs/cut_off_frequency": "the standard's",
  "/line_speed": "not stated",
  "/train/axles/stiffness": "follows from the bounce frequency",
  "/train/axles/damping": "follows from the damping ratio",
};

/**
 * The study's inputs in the order of the editor.
 *
 * @param {Study} study
 * @param {string} kind of the job
 * @param {Study | null} template to compare with
 * @param {any} document with the schemas of the server
 * @returns {Section[]}
 */
export function studySections(study, kind, template, document) {
  const schema = document.components.schemas.Study;
  const whole = completed(schema, study, document);
  const other = template && completed(schema, template, document);
  const changed = other ? differences(other, whole) : [];
  const fields = columnwise(fieldsUnder(schema, whole, "", document), whole).filter(({ pointer }) => pointer !== "/schema_version");
  const row = (/** @type {Field} */ field) => rowOf(field, whole, other, changed);
  return sectionsOf(Object.keys(schema.properties), kind, whole.modes?.part)
    .map(({ title, parts, read }) => ({
      title: read ? title : `${title}, not used here`,
      groups: grouped(
        fields.filter(({ pointer }) => parts.some((part) => pointer === part || pointer.startsWith(`${part}/`))),
        whole,
      ).map(({ title: name, fields: some }) => ({ title: name, rows: some.map(row) })),
    }))
    .filter(({ groups }) => groups.length);
}

/**
 * The fields, one for each column of a long table of numbers: nobody reads samples cell by cell.
 *
 * @param {Field[]} fields
 * @param {Study} study
 * @returns {Field[]}
 */
function columnwise(fields, study) {
  /** @type {Map<string, boolean>} */
  const long = new Map();
  /** @type {Map<string, Field>} */
  const found = new Map();
  for (const field of fields) {
    const [, table = "", key = ""] = /^(.*)\/\d+\/([^/]+)$/.exec(field.pointer) ?? [];
    if (table && !long.has(table)) long.set(table, isLong(at(study, table)));
    const pointer = long.get(table) ? `${table}/${key}` : field.pointer;
    if (!found.has(pointer)) found.set(pointer, long.get(table) ? { ...field, pointer, column: { table, key } } : field);
  }
  return [...found.values()];
}

/** @param {any} rows */
function isLong(rows) {
  return Array.isArray(rows) && rows.length >= LONG && rows.every((row) => Object.values(row ?? {}).every((cell) => typeof cell === "number"));
}

/**
 * What a study holds in a field, in a column all its cells.
 *
 * @param {Study} study
 * @param {Field} field
 */
function valueAt(study, { pointer, column }) {
  if (!column) return at(study, pointer);
  const rows = at(study, column.table);
  return Array.isArray(rows) ? rows.map((row) => row?.[column.key]) : undefined;
}

/**
 * Whether a field is, holds or lies in something that differs.
 *
 * @param {Field} field
 * @param {string} other pointer of what differs
 */
function concerns({ pointer, column }, other) {
  const place = column?.table ?? pointer;
  if (other === "" || other === place || place.startsWith(`${other}/`)) return true;
  return other.startsWith(`${place}/`) && (!column || other.endsWith(`/${column.key}`));
}

/**
 * The template that a study came from: the one of its name, else the one it is most alike.
 *
 * @param {Study} study
 * @param {string} kind of the job
 * @param {Template[]} templates
 * @returns {Template | null}
 */
export function closestTemplate(study, kind, templates) {
  const same = templates.filter((template) => (template.kind ?? "crossing") === kind);
  const named = same.find((template) => template.study.name === study.name);
  const apart = (/** @type {Template} */ template) => differences(template.study, study).length;
  return named ?? same.toSorted((a, b) => apart(a) - apart(b))[0] ?? templates.find((template) => template.study.name === study.name) ?? null;
}

/**
 * Fields that belong to the same thing: a vehicle type, the dampers.
 *
 * @param {Field[]} fields
 * @param {Study} study
 */
function grouped(fields, study) {
  /** @type {Map<string, { title: string, fields: Field[] }>} */
  const groups = new Map();
  for (const field of fields) {
    const parent = field.pointer.slice(0, field.pointer.lastIndexOf("/"));
    const group = groups.get(parent) ?? { title: groupTitle(parent, study), fields: [] };
    groups.set(parent, group);
    group.fields.push(field);
  }
  return [...groups.values()];
}

/**
 * @param {string} pointer
 * @param {Study} study
 */
function groupTitle(pointer, study) {
  const keys = pointer.split("/").slice(1);
  if (keys.length < 1) return "";
  const { name: own, type } = at(study, pointer) ?? {};
  if (type) return titleOf(type);
  const last = keys[keys.length - 1];
  const name = /^\d+$/.test(last) ? `${words(keys[keys.length - 2]).replace(/s$/, "")} ${Number(last) + 1}` : titleOf(pointer, words(last));
  return own && keys.length > 1 ? `${name}: ${String(own).replace(/_/g, " ")}` : name;
}

/**
 * @param {Field} field
 * @param {Study} study
 * @param {Study | null} template
 * @param {string[]} changed pointers of what differs
 * @returns {Row}
 */
function rowOf(field, study, template, changed) {
  const { pointer } = field;
  const differs = changed.some((other) => concerns(field, other));
  const own = said(valueAt(study, field), field);
  const other = template && differs ? said(valueAt(template, field), field) : null;
  return {
    pointer,
    label: titleOf(pointer, field.label),
    ...own,
    standard: other && other.text,
    standardUnit: other?.unit ?? "",
  };
}

/**
 * A value and its unit, or what it stands for.
 *
 * @param {any} value
 * @param {Field} field
 */
function said(value, field) {
  const words = isAllZero(value) ? WHERE_ZERO[field.pointer] : undefined;
  return words ? { text: words, unit: "" } : { text: written(value, field), unit: unitText(field.unit) };
}

/** @param {any} value */
const isAllZero = (value) => (Array.isArray(value) ? value.length > 0 && value.every((cell) => cell === 0) : value === 0);

/**
 * @param {any} value
 * @param {Field} field
 */
function written(value, field) {
  if (field.kind === "switch") return value ? "yes" : "no";
  if (field.column) return Array.isArray(value) ? abridged(value.map((item) => item * (field.unit?.scale ?? 1))) : "–";
  if (field.kind === "choice") return titleOf(String(value)).toLowerCase();
  return shown(value, field).replace(/^-/, "−") || "–";
}
