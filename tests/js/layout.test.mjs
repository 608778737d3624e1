// The drawn train and viaduct have the lengths of the study.
import assert from "node:assert/strict";
import { test } from "node:test";
import { layoutOf } from "../../static/js/layout.js";

const car = (name, articulation, leading, trailing) => ({ name, articulation, leading_distance: leading, trailing_distance: trailing, wheelbase: 3 });
const khst = {
  type: "articulated",
  bogie_gap: 6.275,
  vehicle_types: [car("power", "none", 7, 7), car("motor", "trailing_end", 5.977, 12.723), car("passenger", "both_ends", 9.35, 9.35)],
  consist: ["power", "motor", ...Array(16).fill("passenger"), "motor", "power"],
};

test("the KHST has 20 cars, 46 axles and 380.15 m", () => {
  const { cars, axles } = layoutOf({ train: khst, viaduct: { spans: [16.5, 21, 21] } });
  assert.equal(cars.length, 20);
  assert.equal(axles.length, 46);
  assert.equal(axles[0], 0);
  assert.ok(Math.abs(-axles[45] - 380.15) < 1e-9); // table 6.1 of the thesis
  assert.ok(cars.every((item) => item.front > item.back));
});

test("spans follow each other; the middle of each is an output, that of an inner one is judged", () => {
  const { spans, points } = layoutOf({ viaduct: { spans: [16.5, 21, 21] }, train: {} });
  assert.deepEqual(spans, [[0, 16.5], [16.5, 37.5], [37.5, 58.5]]);
  assert.deepEqual(points, [{ x: 8.25, judged: false }, { x: 27, judged: true }, { x: 48, judged: false }]);
  assert.deepEqual(layoutOf({ viaduct: { spans: [25] }, train: {} }).points, [{ x: 12.5, judged: true }]);
  assert.equal(layoutOf({ viaduct: { type: "beam", spans: [25] }, train: {} }).points[0].judged, false);
});

test("sprung masses and defects are where the study says", () => {
  const layout = layoutOf({
    train: { type: "sprung_masses", count: 4, spacing: 20 },
    viaduct: { spans: [20, 20] },
    irregularity: { type: "isolated", position: 27, rail: "right", amplitude: 0.016, wave_number: 2 },
  });
  assert.deepEqual(layout.masses, [0, -20, -40, -60]);
  assert.deepEqual(layout.defects, [{ position: 27, rail: "right", amplitude: 0.016, width: 3 }]);
});

test("an unfinished study still draws", () => {
  assert.deepEqual(layoutOf({ train: { ...khst, consist: ["unknown"] } }).cars, []);
});
