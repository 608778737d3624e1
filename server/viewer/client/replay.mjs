// @ts-check
/**
 * Even light in a replay, however often it is played.
 *
 * At every new beginning viser's player goes back to its own lamps and its own surroundings for a
 * moment, and the surroundings, which load late, may then stay: colours would no longer be those
 * of their bar. Recorded scenes bring their own lamps, which cast no shadows.
 */

/** @typedef {{ isLight?: boolean, castShadow?: boolean, visible: boolean }} Thing */
/**
 * @typedef {object} Scene
 * @property {unknown} environment
 * @property {(...values: unknown[]) => void} onBeforeRender
 * @property {(visit: (thing: Thing) => void) => void} traverse
 */

const LOOKING_MS = 50;

/** Keeps viser's own light out of a scene. @param {Scene} scene */
export function keepLight(scene) {
  Object.defineProperty(scene, "environment", { get: () => null, set: () => {}, configurable: true });
  const before = scene.onBeforeRender;
  scene.onBeforeRender = (...values) => {
    before.apply(scene, values);
    scene.traverse((thing) => {
      if (thing.isLight && thing.castShadow) thing.visible = false;
    });
  };
}

if (typeof window !== "undefined") {
  const page = /** @type {Window & { __viserMutable?: { scene: Scene | null } }} */ (window);
  const looking = page.setInterval(() => {
    const scene = page.__viserMutable?.scene;
    if (!scene) return;
    page.clearInterval(looking);
    keepLight(scene);
  }, LOOKING_MS);
}
