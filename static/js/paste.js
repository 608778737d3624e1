// @ts-check
/** Tables as spreadsheets put them on the clipboard: tabs, semicolons or commas between. Pure. */

/**
 * The cells of a pasted text, row by row. Tabs win over semicolons, semicolons over commas, so that
 * decimal commas survive wherever something else separates.
 *
 * @param {string} text
 * @returns {string[][]}
 */
export function cellsOf(text) {
  const body = text.replace(/\r\n?/g, "\n").replace(/\n+$/, "");
  const separator = ["\t", ";"].find((mark) => body.includes(mark)) ?? ",";
  return rows(body, separator).map((row) => row.map((cell) => cell.trim()));
}

/**
 * Whether a text is a table and not a single value.
 *
 * @param {string} text
 */
export function isTable(text) {
  return /[\t\n]/.test(text.trim());
}

/**
 * @param {string} body
 * @param {string} separator
 */
function rows(body, separator) {
  /** @type {string[][]} */
  const found = [[""]];
  let quoted = false;
  for (let index = 0; index < body.length; index += 1) {
    const mark = body[index];
    const row = found[found.length - 1];
    if (mark === '"' && quoted && body[index + 1] === '"') {
      row[row.length - 1] += mark;
      index += 1;
    } else if (mark === '"' && (quoted || row[row.length - 1] === "")) quoted = !quoted;
    else if (mark === separator && !quoted) row.push("");
    else if (mark === "\n" && !quoted) found.push([""]);
    else row[row.length - 1] += mark;
  }
  return found;
}

/**
 * A number as a spreadsheet writes it: 1 234,5 or 1,234.5 or 1.234,5; NaN where it is none.
 *
 * @param {string} text
 */
export function numberOf(text) {
  const bare = text.replace(/[\s\u00a0\u202f']/g, "").replace("−", "-");
  if (bare === "") return Number.NaN;
  const comma = bare.lastIndexOf(",");
  const point = bare.lastIndexOf(".");
  if (comma >= 0 && point >= 0) {
    const [thousands, decimal] = comma > point ? [/\./g, ","] : [/,/g, "."];
    return Number(bare.replace(thousands, "").replace(decimal, "."));
  }
  return Number(bare.split(",").length === 2 ? bare.replace(",", ".") : bare);
}

/**
 * Rows without a first one of headings, words where numbers should be, and those of units below it,
 * where nothing is a number.
 *
 * @param {string[][]} table
 * @param {boolean[]} numeric which columns hold numbers
 */
export function withoutHeadings(table, numeric) {
  const wordy = (/** @type {string} */ cell, /** @type {number} */ index) => numeric[index] && cell !== "" && Number.isNaN(numberOf(cell));
  const [first, ...rest] = table;
  if (!rest.length || !first.some(wordy)) return table;
  const isUnits = rest[0].some(wordy) && rest[0].every((cell, index) => !numeric[index] || cell === "" || wordy(cell, index));
  return isUnits && rest.length > 1 ? rest.slice(1) : rest;
}

/**
 * One column or row of numbers or names as the text of a list field; commas are decimal ones.
 *
 * @param {string} text
 */
export function listOf(text) {
  const cells = text.split(/[\t\r\n;]+/).map((cell) => cell.trim()).filter(Boolean);
  const numeric = cells.slice(1).some((cell) => !Number.isNaN(numberOf(cell)));
  const column = withoutHeadings(cells.map((cell) => [cell]), [numeric]).flat();
  return column.map((cell) => (Number.isNaN(numberOf(cell)) ? cell : String(numberOf(cell)))).join(", ");
}

/**
 * A table for the clipboard.
 *
 * @param {(string | number)[][]} table
 */
export function asTabs(table) {
  return table.map((row) => row.map((cell) => String(cell).replace(/[\t\n]/g, " ")).join("\t")).join("\n");
}
