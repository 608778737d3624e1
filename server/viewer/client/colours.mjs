// @ts-check
/**
 * Colours per vertex in viser's page.
 *
 * Viser has no such property on meshes that move. A hidden point cloud therefore carries them: the
 * colours of `/slab` are those of the points `/slab/colours`, three bytes a vertex. Before every
 * picture they are copied into the mesh, so that shape and colours change in the same picture.
 * A cloud of one colour means that its mesh shows its material.
 *
 * `window.trainbridgeColours` says to the page around the view whether this works.
 */

/** @typedef {{ array: ArrayLike<number>, count: number, needsUpdate: boolean }} Attribute */
/**
 * @typedef {object} Shape
 * @property {(name: string) => Attribute | undefined} getAttribute
 * @property {(name: string, attribute: Attribute) => unknown} setAttribute
 * @property {() => void} dispose
 */
/**
 * @typedef {object} Thing
 * @property {boolean} [isMesh]
 * @property {boolean} [isPoints]
 * @property {Shape} geometry
 * @property {{ vertexColors: boolean, toneMapped: boolean, needsUpdate: boolean }} material
 * @property {Thing[]} children
 */
/** @typedef {{ onBeforeRender: (...values: unknown[]) => void }} Scene */
/** @typedef {{ scene: Scene | null, nodeRefFromName: Record<string, Thing | null | undefined>, requestRender: () => void }} Viewer */
/**
 * @typedef {object} Report
 * @property {boolean} ok Whether a mesh and its colours were found.
 * @property {string} reason Why not; empty where it works.
 * @property {number} updates Colours copied so far.
 * @property {string[]} coloured Meshes that show colours now.
 */

const CARRIER = "/colours";
const LOOKING_MS = 100;

/** Linear light of each sRGB level, as 16 bit: eight would show steps in the dark. */
export const LINEAR = Uint16Array.from({ length: 256 }, (_, level) => {
  const value = level / 255;
  const light = value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  return Math.round(65535 * light);
});

/** Colours that a mesh shows already, by its shape. @type {WeakMap<object, ArrayLike<number>>} */
const shown = new WeakMap();

/**
 * Gives a mesh the colours that its carrier has, or its material where there are none.
 *
 * @param {Thing} mesh
 * @param {Thing} points
 * @returns {"copied" | "same" | "plain" | "mismatch"}
 */
export function paint(mesh, points) {
  const position = mesh.geometry.getAttribute("position");
  const carried = points.geometry.getAttribute("color");
  const fits = carried !== undefined && position !== undefined && carried.count === position.count;
  if (mesh.material.vertexColors !== fits) {
    mesh.material.vertexColors = fits;
    mesh.material.toneMapped = !fits; // a film's curve would take the colours off the bar
    mesh.material.needsUpdate = true;
  }
  if (!fits) return carried === undefined ? "plain" : "mismatch";
  const target = colourAttribute(mesh.geometry, position);
  if (shown.get(target) === carried.array) return "same";
  const light = /** @type {Uint16Array} */ (target.array);
  for (let i = 0; i < light.length; i++) light[i] = LINEAR[carried.array[i]];
  target.needsUpdate = true;
  shown.set(target, carried.array);
  return "copied";
}

/**
 * The shape's colours, made anew where the number of its vertices has changed.
 *
 * @param {Shape} geometry
 * @param {Attribute} position Tells the class of attributes, which the page keeps to itself.
 * @returns {Attribute}
 */
function colourAttribute(geometry, position) {
  const present = geometry.getAttribute("color");
  if (present?.count === position.count) return present;
  if (present) geometry.dispose(); // frees the buffers of the old length
  const Class = /** @type {new (array: Uint16Array, size: number, normalized: boolean) => Attribute} */ (
    position.constructor
  );
  const made = new Class(new Uint16Array(3 * position.count), 3, true);
  geometry.setAttribute("color", made);
  return made;
}

/**
 * The first thing of a kind among a node's own things, not its children's.
 *
 * @param {Thing | null | undefined} node
 * @param {"isMesh" | "isPoints"} kind
 * @returns {Thing | undefined}
 */
export function findThing(node, kind) {
  for (const child of node?.children ?? []) {
    if (child[kind]) return child;
    const deeper = child.children.find((grandchild) => grandchild[kind]);
    if (deeper) return deeper;
  }
  return undefined;
}

/**
 * Paints every mesh that has a carrier.
 *
 * @param {Viewer} viewer
 * @param {Report} report Is brought up to date.
 */
export function paintAll(viewer, report) {
  const coloured = [];
  let found = 0;
  for (const name of Object.keys(viewer.nodeRefFromName)) {
    if (!name.endsWith(CARRIER)) continue;
    const parent = name.slice(0, -CARRIER.length);
    const points = findThing(viewer.nodeRefFromName[name], "isPoints");
    const mesh = findThing(viewer.nodeRefFromName[parent], "isMesh");
    if (!points || !mesh) continue;
    found += 1;
    const outcome = paint(mesh, points);
    if (outcome === "copied") report.updates += 1;
    if (outcome === "copied" || outcome === "same") coloured.push(parent.slice(1));
  }
  report.coloured = coloured;
  report.ok = found > 0;
  report.reason = found > 0 ? "" : "no mesh with colours is in the scene";
}

/**
 * Paints before every picture, whatever scene the page makes.
 *
 * @param {Window & { __viserMutable?: Viewer, trainbridgeColours?: Report }} page
 */
function start(page) {
  const report = { ok: false, reason: "viser's scene was not found", updates: 0, coloured: [] };
  page.trainbridgeColours = report;
  /** @type {Scene | null} */
  let hooked = null;
  page.setInterval(() => {
    const viewer = page.__viserMutable;
    const scene = viewer?.scene ?? null;
    if (!viewer || !scene || scene === hooked) return;
    const before = scene.onBeforeRender;
    scene.onBeforeRender = (...values) => {
      before.apply(scene, values);
      try {
        paintAll(viewer, report);
      } catch (error) {
        report.ok = false;
        report.reason = String(error);
      }
    };
    hooked = scene;
    viewer.requestRender();
  }, LOOKING_MS);
}

if (typeof window !== "undefined") start(window);
