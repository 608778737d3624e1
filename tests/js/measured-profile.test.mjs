// The drawing of a measured profile: both rails, the way back to zero, the stretch on the elevation.
import assert from "node:assert/strict";
import { test } from "node:test";
import { profileOf, stretchOf } from "../../static/js/irregularity-profile.js";
import { cellsOf } from "../../static/js/paste.js";
import { studySections } from "../../static/js/study-rows.js";
import { pasted } from "../../static/js/table-edit.js";

const samples = [
  { position: 10, left: 0.001, right: 0.002 },
  { position: 10.5, left: -0.004, right: 0.0 },
  { position: 11.5, left: 0.002, right: -0.001 },
  { position: 12, left: 0.003, right: 0.0 },
];
const profile = { type: "measured", samples, fade: 8 };

test("every sample of both rails is drawn at its place", () => {
  const { x, lines } = profileOf(profile);
  assert.deepEqual(lines.map(({ name }) => name), ["left rail", "right rail"]);
  for (const { position, left, right } of samples) {
    const index = x.indexOf(position);
    assert.deepEqual([lines[0].r[index], lines[1].r[index]], [left, right]);
  }
  assert.ok(x.every((place, index) => index === 0 || place > x[index - 1]), "from left to right");
});

test("beyond its ends the profile falls to zero over the fade", () => {
  const { x, lines } = profileOf(profile);
  assert.deepEqual([x[0], x.at(-1)], [2, 20]);
  for (const { r } of lines) assert.ok(Math.abs(r[0]) < 1e-12 && Math.abs(r.at(-1)) < 1e-12);
  const far = x.findLastIndex((place) => place < 20);
  const part = (x[far] - 12) / 8;
  assert.ok(part > 0.9 && Math.abs(lines[0].r[far] - 0.003 * (1 - part ** 3 * (10 - 15 * part + 6 * part ** 2))) < 1e-12);
});

test("beyond its ends the profile runs on smoothly, as the solver has it", () => {
  // Elevations that solver.irregularities.SampledProfile gives for a sine that ends on its steepest slope.
  const sine = Array.from({ length: 201 }, (_, row) => ({ position: row / 10, left: 1e-3 * Math.sin(0.1 * Math.PI * row), right: 0 }));
  const { x, lines } = profileOf({ type: "measured", fade: 10, samples: sine });
  const solved = [[-1, 0], [-0.4, -0.0008113], [-0.2, -0.0005875], [-0.1, -0.0003116], [20.1, 0.0003116], [20.2, 0.0005875], [20.4, 0.0008113], [21, 0]]; // prettier-ignore
  for (const [place, r] of solved) {
    const index = x.findIndex((value) => value >= place);
    const part = (place - x[index - 1]) / (x[index] - x[index - 1]);
    const drawn = lines[0].r[index - 1] * (1 - part) + lines[0].r[index] * part;
    assert.ok(Math.abs(drawn - r) < 5e-5, `x = ${place}: ${drawn} for ${r}`);
  }
});

test("rails that are alike are one line", () => {
  const alike = samples.map((sample) => ({ ...sample, right: sample.left }));
  assert.deepEqual(profileOf({ ...profile, samples: alike }).lines.map(({ name }) => name), ["both rails"]);
});

test("words say how many samples lie where and how high they are", () => {
  assert.equal(profileOf(profile).words, "4 samples from x = 10 to 12 m, at most 4 mm on the left rail and 2 mm on the right rail.");
});

test("the stretch on the elevation reaches from the first to the last sample, one unit high at most", () => {
  const { from, to, paths } = stretchOf(profile);
  assert.deepEqual([from, to], [10, 12]);
  assert.ok(paths.flat().every(([, r]) => Math.abs(r) <= 1));
  const [low, end] = [10.5, 12].map((place) => paths[0].find(([x]) => x === place)[1]);
  assert.ok(low < -0.8 && Math.abs(end / low + 0.75) < 1e-9, "to scale with each other");
});

test("what is half typed is not drawn, and nothing else is a stretch", () => {
  for (const broken of [{ ...samples[0], left: null }, { position: 3 }, null]) {
    assert.equal(profileOf({ ...profile, samples: [...samples, broken] }), null);
  }
  assert.equal(profileOf({ ...profile, samples: [] }), null);
  assert.equal(profileOf({ ...profile, fade: 0 }), null);
  assert.equal(stretchOf({ type: "isolated", amplitude: 0.01, wave_number: 1, position: 3 }), null);
  assert.equal(stretchOf(undefined), null);
  const level = { type: "measured", fade: 1, samples: samples.map((sample) => ({ ...sample, left: 0, right: 0 })) };
  assert.ok(stretchOf(level).paths[0].every(([, r]) => r === 0), "zeros are drawn as a line");
});

test("thousands of samples are drawn in milliseconds", () => {
  const many = Array.from({ length: 200_000 }, (_, index) => ({ position: index / 4, left: 1e-3, right: 0 }));
  assert.equal(profileOf({ ...profile, samples: many }).lines[1].r.length, 200_064);
});

const column = (name, scale) => ({
  pointer: `/${name}`, name, label: name, help: "", kind: "number", unit: { symbol: "m", display: "", scale },
  minimum: null, maximum: null, exclusiveMinimum: null, exclusiveMaximum: null, options: [],
}); // prettier-ignore
const columns = [column("position", 1), column("left", 1000), column("right", 1000)];
const put = (text, start = { row: 0, column: 0 }) => pasted(samples, columns, cellsOf(text), start, { most: 2000, least: 4, blank: samples[0] });

test("a whole profile takes the place of the one before, a shorter one too", () => {
  const longer = Array.from({ length: 9 }, (_, row) => `${row},5\t${row},25\t-1`);
  const { rows } = put(["x [m]\tleft [mm]\tright [mm]", ...longer].join("\r\n"));
  assert.equal(rows.length, 9);
  assert.deepEqual(rows[8], { position: 8.5, left: 0.00825, right: -0.001 });
  const shorter = pasted(rows, columns, cellsOf(longer.slice(0, 5).join("\n")), { row: 0, column: 0 }, { most: 2000, least: 4, blank: samples[0] });
  assert.equal(shorter.rows.length, 5);
});

test("a column, a block elsewhere or too few rows change their own cells alone", () => {
  assert.equal(put("1\n2").rows.length, 4);
  assert.deepEqual(put("5\t6", { row: 3, column: 1 }).rows.slice(0, 3), samples.slice(0, 3));
  assert.equal(put("0\t1\t2\n1\t1\t2").rows.length, 4, "fewer than a profile needs");
});

test("a job's inputs show a profile column by column, and which column differs from the template", () => {
  const number = { type: "number", unit: { symbol: "m", display: "mm", scale: 1000 } };
  const sample = { type: "object", properties: { position: { type: "number", unit: { symbol: "m" } }, left: number, right: number } };
  const kind = { properties: { type: { const: "measured" }, samples: { type: "array", items: sample }, fade: { type: "number" } } };
  const document = { components: { schemas: { Study: { properties: { irregularity: { oneOf: [{ properties: { type: { const: "none" } } }, kind] } } } } } };
  const many = Array.from({ length: 40 }, (_, row) => ({ position: row / 4, left: (row % 7) / 1000, right: 0 }));
  const study = { irregularity: { ...profile, samples: many } };
  const rowsOf = (/** @type {any} */ template) => studySections(study, "crossing", template, document).flatMap(({ groups }) => groups).flatMap(({ rows }) => rows);
  const texts = Object.fromEntries(rowsOf(null).map(({ pointer, text, unit }) => [pointer, `${text} ${unit}`.trim()]));
  assert.equal(texts["/irregularity/samples/position"], "0:9.75:0.25 m");
  assert.equal(texts["/irregularity/samples/right"], "40 × 0 mm");
  const other = { irregularity: { ...profile, samples: many.with(3, { ...many[3], left: 0.009 }) } };
  assert.deepEqual(rowsOf(other).filter((row) => row.standard !== null).map((row) => row.pointer), ["/irregularity/samples/left"]);
  assert.ok(rowsOf({ irregularity: { type: "none" } }).every((row) => row.standard === "–"));
});
