// @ts-check
import assert from "node:assert/strict";
import { test } from "node:test";

import { LINEAR, paint, paintAll } from "../../server/viewer/client/colours.mjs";

/** As three.js has it, as far as the script looks. */
class BufferAttribute {
  /** @param {ArrayLike<number>} array @param {number} itemSize @param {boolean} [normalized] */
  constructor(array, itemSize, normalized = false) {
    this.array = array;
    this.count = array.length / itemSize;
    this.normalized = normalized;
    this.needsUpdate = false;
  }
}

/** @param {Record<string, BufferAttribute>} attributes */
function shape(attributes) {
  return {
    attributes,
    disposed: 0,
    getAttribute: (/** @type {string} */ name) => attributes[name],
    setAttribute: (/** @type {string} */ name, /** @type {BufferAttribute} */ value) =>
      void (attributes[name] = value),
    dispose() {
      this.disposed += 1;
    },
  };
}

/** @param {number} n */
function mesh(n) {
  return {
    isMesh: true,
    geometry: shape({ position: new BufferAttribute(new Float32Array(3 * n), 3) }),
    material: { vertexColors: false, toneMapped: true, needsUpdate: false },
    children: [],
  };
}

/** @param {number[] | null} colours */
function points(colours) {
  const attributes = { position: new BufferAttribute(new Float32Array(3), 3) };
  const carried = colours && { color: new BufferAttribute(Uint8Array.from(colours), 3, true) };
  return { ...mesh(1), isMesh: false, isPoints: true, geometry: shape({ ...attributes, ...carried }) };
}

test("sRGB becomes linear light that rises with it", () => {
  assert.equal(LINEAR[0], 0);
  assert.equal(LINEAR[255], 65535);
  // IEC 61966-2-1: the middle level is 21.6 percent of the light.
  assert.ok(Math.abs(LINEAR[128] / 65535 - 0.2158) < 1e-3);
  assert.ok(LINEAR.every((light, level) => level === 0 || light > LINEAR[level - 1]));
});

test("a mesh takes the colours of its points once, and again when they change", () => {
  const surface = mesh(2);
  const carrier = points([255, 0, 0, 0, 128, 255]);
  assert.equal(paint(surface, carrier), "copied");
  const colours = surface.geometry.attributes.color;
  assert.deepEqual([...colours.array], [65535, 0, 0, 0, LINEAR[128], 65535]);
  assert.equal(colours.normalized, true);
  assert.equal(surface.material.vertexColors, true);
  assert.equal(surface.material.toneMapped, false);
  assert.equal(paint(surface, carrier), "same");
  carrier.geometry.attributes.color.array = Uint8Array.from([0, 0, 0, 0, 0, 0]);
  assert.equal(paint(surface, carrier), "copied");
  assert.equal(surface.geometry.attributes.color, colours, "the buffer is kept");
  assert.deepEqual([...colours.array], [0, 0, 0, 0, 0, 0]);
});

test("a carrier of one colour gives the mesh its material back", () => {
  const surface = mesh(2);
  paint(surface, points([1, 2, 3, 4, 5, 6]));
  assert.equal(paint(surface, points(null)), "plain");
  assert.equal(surface.material.vertexColors, false);
  assert.equal(surface.material.toneMapped, true);
  assert.equal(surface.material.needsUpdate, true);
});

test("colours of another number of vertices are not shown, and their buffer is freed in time", () => {
  const surface = mesh(2);
  paint(surface, points([1, 2, 3, 4, 5, 6]));
  surface.geometry.attributes.position = new BufferAttribute(new Float32Array(9), 3);
  assert.equal(paint(surface, points([1, 2, 3, 4, 5, 6])), "mismatch");
  assert.equal(surface.material.vertexColors, false);
  assert.equal(paint(surface, points([1, 2, 3, 4, 5, 6, 7, 8, 9])), "copied");
  assert.equal(surface.geometry.disposed, 1);
  assert.equal(surface.geometry.attributes.color.count, 3);
});

test("meshes and carriers are found by their names, and the report says what is coloured", () => {
  const surface = mesh(1);
  const group = (/** @type {unknown[]} */ ...children) => ({ children });
  const report = { ok: false, reason: "", updates: 0, coloured: /** @type {string[]} */ ([]) };
  /** @type {any} */
  const viewer = {
    nodeRefFromName: {
      "/slab": group(surface, group(group(points([9, 9, 9])))),
      "/slab/colours": group(group(points([9, 9, 9]))),
      "/rails": group(mesh(1)),
      "/rails/colours": group(group(points(null))),
      "/wheels": null,
    },
  };
  paintAll(viewer, report);
  assert.deepEqual(report, { ok: true, reason: "", updates: 1, coloured: ["slab"] });
  assert.equal(surface.material.vertexColors, true);
  viewer.nodeRefFromName = { "/wheels": group() };
  paintAll(viewer, report);
  assert.equal(report.ok, false);
  assert.match(report.reason, /no mesh/);
});
