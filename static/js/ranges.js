// @ts-check
/** Lists as people write them: 200:400:10 for a range, 16 x name for a repetition. Pure. */

/** From this many equally spaced numbers on, a list reads better as a range. */
const SHORTEST = 4;
/** So many numbers are read in full. */
const FEW = 24;
/** Steps that differ by less than this are the same, relative to the step. */
const NOISE = 1e-6;
/** A range gives no more numbers than this: whoever types 0:1:1e-9 shall not wait for it. */
export const MOST = 1000;

/** Figures of a number that is only read. */
const READ = 8;

/** @param {number} value */
const tidy = (value) => Number(value.toPrecision(12));

/**
 * The numbers of a range, its end included where a step meets it.
 *
 * @param {string} text like "200:400:10"
 * @returns {{ values: number[], error?: undefined } | { error: string, values?: undefined }}
 */
export function expanded(text) {
  const parts = text.split(":").map((part) => part.trim());
  const [from, to, step] = parts.map((part) => (part === "" ? Number.NaN : Number(part.replace(",", "."))));
  if (parts.length !== 3 || ![from, to, step].every(Number.isFinite)) {
    return { error: "Write a range as start:end:step, for example 200:400:10." };
  }
  const size = Math.abs(step);
  if (size === 0) return { error: "The step of a range cannot be 0." };
  const count = Math.floor(Math.abs(to - from) / size + NOISE) + 1;
  if (count > MOST) return { error: `The range has more than ${MOST} values.` };
  const way = to < from ? -size : size;
  return { values: Array.from({ length: count }, (_, index) => tidy(from + index * way)) };
}

/**
 * Numbers as text; those that are equally spaced as ranges.
 *
 * @param {number[]} given
 * @returns {string}
 */
export function condensed(given) {
  const values = given.map(tidy);
  /** @type {string[]} */
  const parts = [];
  let start = 0;
  while (start < values.length) {
    const end = runEnd(values, start);
    if (end - start + 1 >= SHORTEST) {
      parts.push(`${values[start]}:${values[end]}:${Math.abs(tidy(values[start + 1] - values[start]))}`);
      start = end + 1;
    } else {
      parts.push(String(values[start]));
      start += 1;
    }
  }
  return parts.join(", ");
}

/**
 * Numbers as text to read: equal neighbours once with their count, of many others only the first and
 * the last.
 *
 * @param {number[]} values
 * @returns {string}
 */
export function abridged(values) {
  const size = (/** @type {string} */ text) => text.split(", ").length;
  const read = values.map((value) => Number(value.toPrecision(READ)));
  const [spaced, equal] = [condensed(read), counted(read.map(String))];
  const text = size(equal) < size(spaced) ? equal : spaced;
  if (size(text) <= FEW) return text;
  return `${read.slice(0, 3).join(", ")}, …, ${read[read.length - 1]} (${read.length} values)`;
}

/**
 * The last index of the equally spaced numbers that begin at an index.
 *
 * @param {number[]} values
 * @param {number} start
 */
function runEnd(values, start) {
  const step = values[start + 1] - values[start];
  if (!step) return start;
  let end = start + 1;
  while (end + 1 < values.length && Math.abs(values[end + 1] - values[end] - step) <= Math.abs(step) * NOISE) end += 1;
  return end;
}

/**
 * Names as text; the same name in a row is written once with its count.
 *
 * @param {string[]} names
 */
export function counted(names) {
  /** @type {{ name: string, count: number }[]} */
  const groups = [];
  for (const name of names) {
    const last = groups[groups.length - 1];
    if (last?.name === name) last.count += 1;
    else groups.push({ name, count: 1 });
  }
  return groups.map(({ name, count }) => (count > 1 ? `${count} × ${name}` : name)).join(", ");
}

/**
 * The names of a text; "16 × name", "16 x name" and "16 * name" stand for sixteen.
 *
 * @param {string} text
 * @returns {string[]}
 */
export function named(text) {
  return text
    .split(/[,;\t\n]+/)
    .map((part) => part.trim())
    .filter(Boolean)
    .flatMap((part) => {
      const [, count, name] = /^(\d+)\s*[×x*]\s*(\S.*)$/.exec(part) ?? [];
      return count ? Array(Math.min(Number(count), MOST)).fill(name) : [part];
    });
}
