// @ts-check
/** Inputs that differ and results of runs side by side, as tables. */
import { changeText, inputName, inputTexts, resultGroups, resultText } from "../compare-words.js";
import { h, show } from "../dom.js";
import { unitText } from "../format.js";

/** @typedef {import("../types.js").ComparedInput} ComparedInput */
/** @typedef {import("../types.js").ComparedResult} ComparedResult */
/** @typedef {import("../types.js").Comparison} Comparison */

/** Differences that are shown without a fold. */
const FEW = 16;

export class CompareTables extends HTMLElement {
  /**
   * @param {Comparison} comparison
   * @param {string[]} names
   */
  bind({ inputs, results }, names) {
    show(
      this,
      h("section", { class: "card sheet", "aria-label": "Inputs that differ" }, h("h2", null, "Inputs that differ"), inputPart(inputs, names)),
      h("section", { class: "card sheet", "aria-label": "Results" }, h("h2", null, "Results"), results.length ? resultPart(results, names) : h("p", { class: "soft" }, "No run is done yet.")),
    );
  }
}

/**
 * @param {ComparedInput[]} inputs
 * @param {string[]} names
 */
function inputPart(inputs, names) {
  if (!inputs.length) return h("p", { class: "soft" }, "None: these runs have the same inputs.");
  const table = region(
    "Inputs that differ",
    [h("th", { scope: "col" }, "Part"), h("th", { scope: "col", class: "said" }, "Input"), ...heads(names, true)],
    inputs.map((input) => inputRow(input)),
  );
  if (inputs.length <= FEW) return table;
  return h("details", null, h("summary", null, `${inputs.length} inputs differ`), table);
}

/** @param {ComparedInput} input */
function inputRow({ pointer, unit, values }) {
  const { section, name } = inputName(pointer);
  const texts = inputTexts(values, unit);
  return h(
    "tr",
    null,
    h("td", { class: "part soft" }, section),
    h("th", { scope: "row" }, name),
    texts.map((text, index) => h("td", { class: index && text !== texts[0] ? "said other" : "said" }, text)),
  );
}

/**
 * @param {ComparedResult[]} results
 * @param {string[]} names
 */
function resultPart(results, names) {
  return resultGroups(results).map(({ title, open, results: some }) =>
    h("details", { class: "compare-group", open }, h("summary", null, title, h("span", { class: "soft small" }, ` ${some.length}`)), resultTable(title, some, names)),
  );
}

/**
 * @param {string} title
 * @param {ComparedResult[]} results
 * @param {string[]} names
 */
function resultTable(title, results, names) {
  return region(
    title,
    [h("th", { scope: "col" }, "Result"), h("th", { scope: "col" }, "unit"), ...heads(names)],
    results.map((result) =>
      h(
        "tr",
        null,
        h("th", { scope: "row" }, result.name.charAt(0).toUpperCase() + result.name.slice(1)),
        h("td", { class: "soft" }, unitText(result.unit) || "–"),
        result.values.map((value, index) => cell(result, value, index)),
      ),
    ),
  );
}

/**
 * @param {ComparedResult} result
 * @param {number | null} value
 * @param {number} index
 */
function cell(result, value, index) {
  const change = index ? changeText(result.changes[index]) : "";
  const remark = value === null ? "" : result.remarks[index];
  return h(
    "td",
    null,
    h("span", { class: "value" }, resultText(value, result.unit)),
    change && h("span", { class: "change" }, change),
    remark && h("span", { class: remark.startsWith("exceeds") ? "remark exceeds" : "remark" }, remark),
  );
}

/**
 * @param {string[]} names
 * @param {boolean} [said] whether words stand below, not numbers
 */
const heads = (names, said = false) => names.map((name, index) => h("th", { scope: "col", class: said ? "run-head said" : "run-head" }, name, index === 0 && h("span", { class: "soft small" }, " baseline")));

/**
 * @param {string} label
 * @param {HTMLElement[]} head
 * @param {HTMLElement[]} rows
 */
function region(label, head, rows) {
  return h("div", { class: "scroll compare-table", tabindex: "0", role: "region", "aria-label": label }, h("table", null, h("thead", null, h("tr", null, head)), h("tbody", null, rows)));
}

customElements.define("tb-compare-tables", CompareTables);
