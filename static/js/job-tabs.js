// @ts-check
/** Which tabs a job has, and which figures stand in each. Pure. */

/** @typedef {import("./types.js").Job} Job */
/** @typedef {import("./types.js").FigureItem} FigureItem */
/** @typedef {{ id: string, title: string, figures: FigureItem[] }} Tab */

/** Of a server that cannot list them. @type {FigureItem[]} */
export const FIRST_FIGURES = [
  { name: "slab-acceleration", title: "Vertical acceleration" },
  { name: "contact-force", title: "Contact force" },
  { name: "displacement", title: "Displacement" },
];

/** Tabs with figures, and the figures that belong there, in this order. @type {[string, string, string[]][]} */
const PLOTS = [
  ["overview", "Overview", ["slab-acceleration", "contact-force", "displacement"]],
  ["accelerations", "Accelerations", ["slab-acceleration", "envelope", "spectrum"]],
  ["contact-forces", "Contact forces", ["contact-force"]],
  ["vehicle", "Vehicle", ["vehicle-acceleration"]],
  ["slab-map", "Slab map", ["slab-map"]],
];

/** Figures that need a place: they open where somebody points. */
export const POINT_FIGURES = ["point-acceleration", "point-displacement"];

/** Tabs of a job of which nothing is computed yet. @type {Tab[]} */
export const FIRST_TABS = [
  { id: "inputs", title: "Inputs", figures: [] },
  { id: "log", title: "Log", figures: [] },
];

/**
 * @param {Pick<Job, "kind" | "runs">} job
 * @param {FigureItem[]} figures that the shown run has
 * @returns {Tab[]}
 */
export function tabsOf(job, figures) {
  const known = new Map(figures.map((figure) => [figure.name, figure]));
  const plots = PLOTS.map(([id, title, names]) => ({ id, title, figures: names.flatMap((name) => known.get(name) ?? []) }));
  const shown = job.kind === "modes" ? [{ id: "overview", title: "Modes", figures: [] }] : plots.filter((tab) => tab.id === "overview" || tab.figures.length);
  const others = [
    ...(job.kind !== "modes" && job.runs.length > 1 ? [{ id: "sweep", title: "Sweep" }] : []),
    { id: "inputs", title: "Inputs" },
    { id: "log", title: "Log" },
    { id: "files", title: "Files" },
  ];
  return [...shown, ...others.map((tab) => ({ ...tab, figures: [] }))];
}
