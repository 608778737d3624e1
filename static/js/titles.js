// @ts-check
/** Words in place of a field's own name, where that would read badly. Pure. */

/** @type {Record<string, string>} */
const TITLES = {
  "/sweep/speeds": "Speeds",
  "/outputs/cut_off_frequency": "Cut-off frequency",
  "/integration/alpha": "Alpha of HHT",
  "/irregularity/wave_number": "Wave number k",
  "/irregularity/amplitude": "Amplitude A",
  "/irregularity/position": "Position x₀",
  none: "None",
  isolated: "Isolated defect",
  measured: "Measured profile",
  u_girder: "Box girder viaduct",
  beam: "Plain beams",
  articulated: "Articulated train",
  sprung_masses: "Sprung masses",
  axle_table: "Table of axles",
  ballasted: "Ballasted track",
};

/** @type {Record<string, string>} */
const HELP = {
  "/sweep/speeds": "One run each. Several between commas, or a range as start:end:step: 200:400:10.",
  "/train/consist": "Names of the vehicle types, from the first car to the last; 16 × name for sixteen of them.",
};

/** What the alternatives of the irregularity do, in a formula. @type {Record<string, string>} */
export const FORMULAS = {
  isolated: "r(x) = A exp(−k²(x − x₀)² / 2)",
};

/** Names that stand in formulas and laws. @type {[RegExp, string][]} */
const NAMES = [
  [/\bhertz\b/gi, "Hertz"],
  [/\byoung modulus\b/gi, "Young’s modulus"],
  [/\bpoisson ratio\b/gi, "Poisson’s ratio"],
  [/\bhertz constant\b/gi, "Hertz’s constant"],
  [/\bHHT\b/gi, "HHT"],
];

/**
 * A field's name in words: "rail_young_modulus" reads "Rail Young’s modulus".
 *
 * @param {string} name
 */
export function words(name) {
  const plain = NAMES.reduce((text, [pattern, word]) => text.replace(pattern, word), name.replace(/_/g, " "));
  return plain.charAt(0).toUpperCase() + plain.slice(1);
}

/**
 * @param {string} key a field's pointer or an alternative's tag
 * @param {string} [own] the name without a better one
 */
export function titleOf(key, own) {
  return TITLES[key] ?? own ?? words(key);
}

/**
 * @param {string} pointer
 * @param {string} own
 */
export function helpOf(pointer, own) {
  return HELP[pointer] ?? own;
}
