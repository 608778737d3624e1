// What the 3D view shows first: a round scale, and the moment that matters.
import assert from "node:assert/strict";
import { test } from "node:test";
import { momentOfInterest } from "../../static/js/moment.js";
import { pleasingScale } from "../../static/js/scale.js";

const rows = (minimum, maximum) => [{ minimum, maximum }];

test("the scale is round, lets the deformation be seen, and never magnifies noise", () => {
  assert.equal(pleasingScale(rows(-3, 1)), 200); // 3 mm become 0.6 m
  assert.equal(pleasingScale(rows(-5, 7)), 50);
  assert.equal(pleasingScale(rows(-1e-9, 0)), 500);
  assert.equal(pleasingScale([]), 500);
  assert.equal(pleasingScale(rows(-5000, null)), 1);
});

test("the moment is the verdict's, else when the bridge is lowest", () => {
  assert.equal(momentOfInterest({ verdicts: [{ time: 1.9 }] }), 1.9);
  const peaks = { "wheel 1/displacement": { time_of_least: 9 }, "mid-span 1/displacement": { time_of_least: 0.4 } };
  assert.equal(momentOfInterest({ verdicts: [], summary: { peaks } }), 0.4);
  assert.equal(momentOfInterest({ summary: null }), null);
});
