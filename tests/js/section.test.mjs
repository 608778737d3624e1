// The drawn cross-section has the measures of the study.
import assert from "node:assert/strict";
import { test } from "node:test";
import { levelsOf } from "../../static/js/layout.js";
import { sectionOf } from "../../static/js/section.js";

const alverca = {
  viaduct: { type: "u_girder", spans: [16.5, 21, 21], slab_width: 7.2, slab_thickness: 0.27, slab_level: 1.335, web_position: 1.55, web_thickness: 0.2, bottom_thickness: 0.18, wall_position: 2.15, wall_thickness: 0.25, wall_height: 0.7, bearing_position: 1.55 },
  track: { type: "ballasted", ballast_width: 4.3, ballast_depth: 0.313, sleeper_height: 0.23, sleeper_length: 2.6, sleeper_top_length: 2.55, rail_position: 0.7175 },
  train: { type: "articulated", wheel_lateral_distance: 1.435, vehicle_types: [{ primary_spacing: 2, secondary_spacing: 2.46 }] },
  irregularity: { type: "isolated", position: 27, amplitude: 0.016, rail: "right" },
};
const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test("the rail lies where the solver has it, above slab, ballast, sleeper", () => {
  const { size } = sectionOf(alverca);
  near(size.rail, 1.335 + 0.135 + 0.313 + 0.23 + 0.172);
  near(size.depth, 1.47);
  near(levelsOf(alverca).soffit, size.rail);
  assert.equal(size.width, 7.2);
});

test("the left is the left: a defect of the right rail lies at y < 0, on its head", () => {
  const [defect, ...others] = sectionOf(alverca).defects;
  assert.deepEqual(others, []);
  near(defect.y, -0.7175);
  assert.equal(defect.dip, false);
  assert.equal(sectionOf({ ...alverca, irregularity: { ...alverca.irregularity, rail: "both", amplitude: -0.01 } }).defects.length, 2);
});

test("output points are on the axis and under the rails, as the solver records them", () => {
  assert.deepEqual(sectionOf(alverca).points.map(({ y, z }) => [y, z]), [[0, 1.335], [0.7175, 1.335], [-0.7175, 1.335]]);
});

test("wheels stand on the rails", () => {
  const wheels = sectionOf(alverca).shapes.filter(({ part }) => part === "wheel");
  assert.equal(wheels.length, 2);
  for (const { corners } of wheels) near(Math.min(...corners.map(([, z]) => z)), sectionOf(alverca).size.rail);
});

test("without a load there is the deck alone", () => {
  const { shapes, points, defects } = sectionOf(alverca, false);
  assert.ok(!shapes.some(({ part }) => part === "wheel" || part === "body"));
  assert.deepEqual([points, defects], [[], []]);
});

test("a plain beam and half-typed values still draw finite shapes", () => {
  const beam = { viaduct: { type: "beam", spans: [25], width: 4 }, track: { type: "none" }, train: { type: "sprung_masses" }, irregularity: { type: "none" } };
  const odd = { viaduct: { type: "u_girder", spans: "x", slab_level: null, slab_width: -1 }, track: { type: "ballasted", ballast_depth: "deep" }, train: { type: "articulated", vehicle_types: 3, consist: 7 } };
  for (const study of [beam, odd, {}]) {
    const { shapes } = sectionOf(study);
    assert.ok(shapes.length > 0);
    assert.ok(shapes.every(({ corners }) => corners.flat().every(Number.isFinite)));
  }
});
