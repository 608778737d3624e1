// @ts-check
/** What typing and pasting do to a table of inputs. Pure. */
import { entered } from "./entry.js";
import { numberOf, withoutHeadings } from "./paste.js";
import { at, withValue } from "./pointer.js";

/** @typedef {import("./schema.js").Field} Field */
/** @typedef {{ rows: any[], refused: string[] }} Pasted refused says in words which cells were left as they were */

/** From this many columns on, the table stands on its side: one column for each row of the study. */
const WIDE = 7;

/** @param {Field[]} columns */
export const isTransposed = (columns) => columns.length >= WIDE;

/**
 * A cell as a spreadsheet writes it, as an entry of the form reads it.
 *
 * @param {string} text
 * @param {Field} column
 */
function typed(text, column) {
  const numeric = column.kind === "number" || column.kind === "integer";
  const value = numeric ? numberOf(text) : Number.NaN;
  return entered(Number.isNaN(value) ? text : String(value), column);
}

/**
 * Rows with a block of cells put in; rows that are missing are added as copies of the last. A block
 * at the first cell that has all columns a row must have is the whole table: rows beyond it go.
 *
 * @param {any[]} rows
 * @param {Field[]} columns
 * @param {string[][]} block as it lies on the screen
 * @param {{ row: number, column: number }} start of the study's rows and columns
 * @param {{ most: number, least?: number, blank: any }} limits
 * @returns {Pasted}
 */
export function pasted(rows, columns, block, start, { most, least = 1, blank }) {
  const turned = isTransposed(columns) ? turn(block) : block;
  const numeric = columns.slice(start.column).map((column) => column.kind === "number" || column.kind === "integer");
  const table = withoutHeadings(turned, numeric);
  /** @type {string[]} */
  const refused = [];
  const first = start.row === 0 && start.column === 0 && !isTransposed(columns);
  const whole = first && table.length >= least && table.every((cells) => cells.length >= needed(columns));
  let changed = whole ? rows.slice(0, table.length) : [...rows];
  for (const [down, cells] of table.entries()) {
    const row = start.row + down;
    if (row >= most) {
      refused.push(`More than ${most} rows`);
      break;
    }
    if (row >= changed.length) changed = [...changed, structuredClone(changed[changed.length - 1] ?? blank)];
    for (const [along, text] of cells.entries()) {
      const column = columns[start.column + along];
      if (!column || text === "") continue;
      const entry = typed(text, column);
      if (entry.error !== undefined) refused.push(`${column.label}, row ${row + 1}: ${entry.error}`);
      else changed[row] = withValue(changed[row], column.pointer, entry.value);
    }
  }
  return { rows: changed, refused };
}

/**
 * How many columns from the first on hold all that a row must have: the others have a standard.
 *
 * @param {Field[]} columns
 */
function needed(columns) {
  return columns.findLastIndex(({ standard }) => standard === undefined) + 1 || columns.length;
}

/**
 * A block on its side.
 *
 * @param {string[][]} block
 * @returns {string[][]}
 */
export function turn(block) {
  const width = Math.max(...block.map((row) => row.length), 0);
  return Array.from({ length: width }, (_, index) => block.map((row) => row[index] ?? ""));
}

/**
 * What a row of the study is called: its name, else its number.
 *
 * @param {any} row
 * @param {number} index
 */
export function rowName(row, index) {
  const name = at(row, "/name");
  return typeof name === "string" && name ? name : String(index + 1);
}
