// @ts-check
/** The numbers behind a figure as a table, and the data of each curve as a file. */
import { h } from "../dom.js";
import { label, number } from "../format.js";

/** @typedef {import("../types.js").Figure} Figure */
/** @typedef {Record<string, any>} Row */

/**
 * @param {Figure} figure
 * @param {(channel: string) => string} [channelUrl] address of a channel's data
 */
export function figureTable(figure, channelUrl) {
  const rows = figure.table;
  if (!rows.length) return h("p", { class: "soft small" }, "Nothing is drawn yet.");
  const columns = "minimum" in rows[0] ? extremes() : named(rows[0]);
  const files = channelUrl && rows.some((row) => row.channel);
  return h(
    "table",
    null,
    h("thead", null, h("tr", null, columns.map(({ head }) => h("th", { scope: "col" }, head)), files && h("th", { scope: "col" }, "Data"))),
    h(
      "tbody",
      null,
      rows.map((row) =>
        h(
          "tr",
          null,
          columns.map(({ text }, index) => h(index === 0 ? "th" : "td", { scope: index === 0 && "row" }, text(row))),
          files && h("td", null, row.channel && h("a", { href: channelUrl(row.channel), download: "" }, "CSV")),
        ),
      ),
    ),
  );
}

/** Columns of curves over time. */
function extremes() {
  const moment = (/** @type {number | null} */ time) => time?.toFixed(4) ?? "–";
  return [
    { head: "Curve", text: (/** @type {Row} */ row) => row.curve },
    { head: "least", text: (/** @type {Row} */ row) => `${number(row.minimum, 4)} ${row.unit}` },
    { head: "at t [s]", text: (/** @type {Row} */ row) => moment(row.minimum_time) },
    { head: "greatest", text: (/** @type {Row} */ row) => `${number(row.maximum, 4)} ${row.unit}` },
    { head: "at t [s]", text: (/** @type {Row} */ row) => moment(row.maximum_time) },
  ];
}

/**
 * Columns of whatever a figure says of its marks.
 *
 * @param {Row} first
 */
function named(first) {
  return Object.keys(first)
    .filter((key) => key !== "unit" && key !== "channel" && key !== "run")
    .map((key) => ({ head: headed(key, first), text: (/** @type {Row} */ row) => cell(row[key]) }));
}

/**
 * @param {string} key
 * @param {Row} first
 */
const headed = (key, first) => (key === "value" && first.unit ? `Value [${first.unit}]` : label(key));

/** @param {unknown} value */
function cell(value) {
  if (typeof value === "number") return number(value, 4);
  if (value === null || value === undefined) return "–";
  return String(value);
}
