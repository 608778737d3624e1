// @ts-check
/** Words in place of a field's own name, where that would read badly. Pure. */
import { label } from "./format.js";

/** @type {Record<string, string>} */
const TITLES = {
  "/sweep/speeds": "Speed",
  "/outputs/cut_off_frequency": "Cut-off frequency",
  "/integration/alpha": "Alpha of HHT",
  "/irregularity/wave_number": "Wave number k",
  "/irregularity/amplitude": "Amplitude A",
  "/irregularity/position": "Position x₀",
  none: "None",
  isolated: "Isolated defect",
};

/** @type {Record<string, string>} */
const HELP = {
  "/sweep/speeds": "Several speeds make a sweep, one run each: 200, 300, 432.",
};

/** What the alternatives of the irregularity do, in a formula. @type {Record<string, string>} */
export const FORMULAS = {
  isolated: "r(x) = A exp(−k²(x − x₀)² / 2)",
};

/**
 * @param {string} key a field's pointer or an alternative's tag
 * @param {string} [own] the name without a better one
 */
export function titleOf(key, own) {
  return TITLES[key] ?? own ?? label(key);
}

/**
 * @param {string} pointer
 * @param {string} own
 */
export function helpOf(pointer, own) {
  return HELP[pointer] ?? own;
}
