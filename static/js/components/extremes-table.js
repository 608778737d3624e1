// @ts-check
/** The numbers behind a figure: extremes of each curve, and its data as a file. */
import { channelUrl } from "../api.js";
import { h } from "../dom.js";
import { number } from "../format.js";

/** @typedef {import("../types.js").Figure} Figure */

/**
 * @param {Figure} figure
 * @param {string} run
 */
export function extremesTable(figure, run) {
  const heads = ["Curve", "least", "at t [s]", "greatest", "at t [s]", "Data"];
  return h(
    "table",
    null,
    h("thead", null, h("tr", null, heads.map((text) => h("th", { scope: "col" }, text)))),
    h(
      "tbody",
      null,
      figure.table.map((row) =>
        h(
          "tr",
          null,
          h("th", { scope: "row" }, row.curve),
          h("td", null, `${number(row.minimum, 4)} ${row.unit}`),
          h("td", null, row.minimum_time?.toFixed(4) ?? "–"),
          h("td", null, `${number(row.maximum, 4)} ${row.unit}`),
          h("td", null, row.maximum_time?.toFixed(4) ?? "–"),
          h("td", null, row.channel && h("a", { href: channelUrl(run, row.channel), download: "" }, "CSV")),
        ),
      ),
    ),
  );
}
