// @ts-check
/** How the inputs of a study are laid out on the page: sections, and what is basic in each. Pure.
 *
 * Only order and place are said here; names, units, bounds and help are the schema's. What nobody
 * placed gets a section of its own, so that a new field of the solver is never missing.
 */
import { words } from "./titles.js";

/** @typedef {import("./form-plan.js").Node} Node */
/** @typedef {{ name: string, title: string, parts: string[] }} Place parts are pointers, in order */
/** @typedef {Place & { read: boolean }} Section read: whether the job that is asked for looks at it */

/** @type {Place[]} */
const SECTIONS = [
  { name: "viaduct", title: "Viaduct", parts: ["/viaduct", "/mesh_level"] },
  { name: "train", title: "Train", parts: ["/train"] },
  { name: "track", title: "Track", parts: ["/track", "/approach"] },
  { name: "irregularities", title: "Irregularities", parts: ["/irregularity"] },
  { name: "contact", title: "Contact", parts: ["/contact"] },
  { name: "integration", title: "Integration", parts: ["/integration", "/extent"] },
  { name: "speeds", title: "Speeds", parts: ["/sweep", "/line_speed"] },
  { name: "outputs", title: "Outputs", parts: ["/outputs"] },
  { name: "modes", title: "Modes", parts: ["/modes"] },
];

/** Drawn in the page's head, or not at all. */
const ELSEWHERE = ["/name", "/schema_version"];
/** What only one kind of job reads. @type {Record<string, string>} */
const ONLY = { modes: "modes" };
/** How fine the model is goes with what is asked for: a modal analysis may have no viaduct. */
const FINENESS = "/mesh_level";
/** What a modal analysis of each part reads, beside `modes`. @type {Record<string, string[]>} */
const MODAL = {
  viaduct: ["viaduct", "track"],
  track: ["track"],
  train: ["train", "contact"],
};
/** The input that decides which sections are read. */
export const DECIDES = "/modes/part";

/** What most people change, beside the choice of a kind. Smaller sections are all basic. */
const BASIC = new Set([
  "/viaduct/spans", "/viaduct/slab_width", "/viaduct/slab_thickness", "/mesh_level",
  "/viaduct/young_modulus", "/viaduct/second_moment", "/viaduct/mass_per_length",
  "/train/name", "/train/consist", "/train/mass", "/train/stiffness", "/train/damping", "/train/count", "/train/spacing",
  "/train/axles", "/train/bounce_frequency", "/train/damping_ratio",
  "/track/sleeper_spacing", "/track/pad_stiffness", "/track/ballast_depth",
  "/integration/time_step", "/integration/alpha",
]); // prettier-ignore
/** A section with no more inputs than this folds nothing away. */
const SMALL = 5;

/**
 * The sections of a study; what the job does not read comes last.
 *
 * @param {string[]} keys properties of the study's schema
 * @param {string} kind of the job
 * @param {string} [part] whose modes are asked for
 * @returns {Section[]}
 */
export function sectionsOf(keys, kind, part = "") {
  const pointers = keys.map((key) => `/${key}`);
  const places = kind === "modes" ? SECTIONS.map((place) => modal(place, part)) : SECTIONS;
  const placed = new Set([...places.flatMap((place) => place.parts), ...ELSEWHERE]);
  const own = places.map((place) => ({ ...place, parts: place.parts.filter((pointer) => pointers.includes(pointer)) }));
  const rest = pointers
    .filter((pointer) => !placed.has(pointer))
    .map((pointer) => ({ name: pointer.slice(1), title: words(pointer.slice(1)), parts: [pointer] }));
  const shown = [...own, ...rest].filter(({ name, parts }) => parts.length && (!ONLY[name] || ONLY[name] === kind));
  const all = shown.map((place) => ({ ...place, read: reads(place.name, kind, part) }));
  const rank = (/** @type {Section} */ { name, read }) => (ONLY[name] ? 0 : read ? 1 : 2);
  return all.toSorted((one, other) => rank(one) - rank(other));
}

/**
 * Whether a job looks at a section. What nobody placed may matter.
 *
 * @param {string} name
 * @param {string} kind
 * @param {string} part
 */
function reads(name, kind, part) {
  if (kind !== "modes" || ONLY[name] || !SECTIONS.some((place) => place.name === name)) return true;
  return MODAL[part]?.includes(name) ?? true;
}

/**
 * A section as a modal analysis has it: the mesh stands beside the number of modes.
 *
 * @param {Place} place
 * @param {string} part
 * @returns {Place}
 */
function modal(place, part) {
  if (part === "train") return place;
  const parts = place.parts.filter((pointer) => pointer !== FINENESS);
  return { ...place, parts: place.name === ONLY.modes ? [...parts, FINENESS] : parts };
}

/**
 * The inputs of a section in two parts: always shown, and folded.
 *
 * @param {Node[]} nodes of the section's parts
 * @returns {{ basic: Node[], advanced: Node[] }}
 */
export function folded(nodes) {
  const all = nodes.flatMap((node) => (node.type === "group" ? node.children : [node]));
  const count = all.reduce((sum, node) => sum + inputs(node), 0);
  if (count <= SMALL) return { basic: nodes.flatMap(opened), advanced: [] };
  const basic = nodes.flatMap(opened).filter((node) => node.type === "choice" || BASIC.has(node.pointer));
  const open = new Set(basic.map((node) => node.pointer));
  const advanced = nodes.flatMap((node) => (node.type === "choice" ? node.children : [node])).map((node) => rest(node, open));
  return { basic, advanced: advanced.filter((node) => node !== null) };
}

/**
 * The nodes that lie open in a part: of a choice the choice itself, then what it holds.
 *
 * @param {Node} node
 * @returns {Node[]}
 */
function opened(node) {
  if (node.type === "choice") return [{ ...node, children: [] }, ...node.children];
  return node.type === "group" ? node.children : [node];
}

/**
 * A node without what lies open; null where nothing is left.
 *
 * @param {Node} node
 * @param {Set<string>} open
 * @returns {Node | null}
 */
function rest(node, open) {
  if (open.has(node.pointer)) return null;
  if (node.type !== "group") return node;
  const children = node.children.map((child) => rest(child, open)).filter((child) => child !== null);
  return children.length ? { ...node, children } : null;
}

/**
 * How many inputs a node holds.
 *
 * @param {Node} node
 * @returns {number}
 */
export function inputs(node) {
  if (node.type === "field") return 1;
  if (node.type === "table") return Math.max(node.columns.length, 1);
  return node.children.reduce((sum, child) => sum + inputs(child), 0);
}
