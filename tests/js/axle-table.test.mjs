// What the pages make of a train that is a table of axles: places, boxes, loads, labels, pasting.
import assert from "node:assert/strict";
import { test } from "node:test";

import { axleGroups, axleLabels, axleLoads } from "../../static/js/axle-loads.js";
import { exportsOf } from "../../static/js/code-export.js";
import { layoutOf } from "../../static/js/layout.js";
import { studyAround } from "../../static/js/library-parts.js";
import { cellsOf, isTable } from "../../static/js/paste.js";
import { sectionOf } from "../../static/js/section.js";
import { studySections } from "../../static/js/study-rows.js";
import { pasted } from "../../static/js/table-edit.js";
import { titleOf } from "../../static/js/titles.js";

const axle = (position, load = 170e3) => ({ position, load, unsprung_mass: 0, stiffness: 0, damping: 0 });
const table = (...places) => ({ type: "axle_table", name: "table", axles: places.map((place) => axle(place)) });

test("axles are drawn where the table has them, the first at the head", () => {
  const layout = layoutOf({ train: table(4.2, 6.7, 21.7), viaduct: { spans: [25] } });
  assert.deepEqual(layout.masses.map((x) => Number(x.toFixed(9))), [0, -2.5, -17.5]);
  assert.deepEqual(layout.cars, []);
  assert.deepEqual(layout.axles, []);
});

test("boxes stand beside each other however close the axles are", () => {
  const boxOf = (...places) => layoutOf({ train: table(...places) }).box;
  assert.equal(boxOf(0), 3);
  assert.equal(boxOf(0, 20), 3);
  assert.equal(boxOf(0, 2, 18), 1.4);
  // Two rows at the same place, as while typing: the rest decides.
  assert.equal(boxOf(0, 0, 2), 1.4);
  assert.ok(boxOf(0, 0.1) > 0);
  assert.equal(layoutOf({ train: { type: "sprung_masses", count: 2, spacing: 20 } }).box, 3);
});

test("a table that is being typed does not break the drawing", () => {
  for (const axles of [undefined, [], [{}], [{ position: null }], "x"]) {
    const train = { type: "axle_table", axles };
    assert.deepEqual(layoutOf({ train }).masses, []);
    assert.deepEqual(axleLoads(train), []);
  }
});

test("loads are masses times the solver's gravity", () => {
  const loads = axleLoads({ type: "axle_table", axles: [axle(0, 98100), axle(3, 98100), axle(14, 196200)] });
  assert.deepEqual(loads.map((load) => Number(load.toFixed(6))), [10000, 10000, 20000]);
  assert.deepEqual(axleGroups(loads).map(({ first, last }) => [first, last]), [[1, 2], [3, 3]]); // prettier-ignore
});

test("close axles of one load share a label, those of different loads take turns in two rows", () => {
  const labels = axleLabels([0, -3, -14, -16, -30], [10, 10, 20, 30, 10]);
  assert.deepEqual(labels, [
    { x: -1.5, load: 10, lower: false },
    { x: -14, load: 20, lower: false },
    { x: -16, load: 30, lower: true },
    { x: -30, load: 10, lower: false },
  ]);
});

test("the section has one wheel on a beam and two on a track", () => {
  const wheels = (viaduct, track) => sectionOf({ train: table(0), viaduct, track }).shapes.filter((shape) => shape.part === "wheel").length;
  assert.equal(wheels({ type: "beam", spans: [25] }, { type: "none" }), 1);
  assert.equal(wheels({ type: "u_girder", spans: [21], slab_level: 1.335 }, { type: "ballasted" }), 2);
});

/** Columns as the server's schema gives them. */
const number = (pointer, unit = null, standard = undefined, minimum = 0) => ({
  pointer, kind: "number", label: pointer.slice(1), help: "", unit, minimum, maximum: null, above: false, below: false,
  options: [], most: null, whole: false, optional: false, standard,
}); // prettier-ignore
const COLUMNS = [
  number("/position", { symbol: "m", display: "m", scale: 1 }),
  number("/load", { symbol: "N", display: "kN", scale: 1e-3 }),
  number("/unsprung_mass", { symbol: "kg", display: "t", scale: 1e-3 }, 0),
  number("/stiffness", { symbol: "N/m", display: "MN/m", scale: 1e-6 }, 0),
  number("/damping", { symbol: "N s/m", display: "kN s/m", scale: 1e-3 }, 0),
];
const LIMITS = { most: 200, blank: axle(0) };
const paste = (text, rows = [axle(0)]) => pasted(rows, COLUMNS, cellsOf(text), { row: 0, column: 0 }, LIMITS);

test("two columns of a spreadsheet, headings and decimal commas, are the axles in newtons", () => {
  const text = "x [m]\tP [kN]\n0,0\t170,5\n2,5\t170,5\n17,5\t1\u202f165,25\n";
  assert.ok(isTable(text));
  const { rows, refused } = paste(text);
  assert.deepEqual(refused, []);
  assert.deepEqual(rows, [axle(0, 170500), axle(2.5, 170500), axle(17.5, 1165250)]);
});

test("positions and loads of a shorter train leave none of a longer one's axles behind", () => {
  const long = Array.from({ length: 50 }, (_, index) => axle(8 * index));
  assert.deepEqual(paste("0\t150\n2,5\t150", long).rows, [axle(0, 150e3), axle(2.5, 150e3)]);
  const places = paste("0\n2,5", long).rows;
  assert.equal(places.length, 50, "a column alone is no table");
});

test("what follows from the table is no zero, and equal loads are counted", () => {
  const rowOf = { type: "object", properties: { position: { type: "number" }, load: { type: "number" }, stiffness: { type: "number", default: 0 } }, required: ["position", "load"] };
  const kind = { properties: { type: { const: "axle_table" }, axles: { type: "array", items: rowOf } } };
  const document = { components: { schemas: { Study: { properties: { train: { oneOf: [kind] } } } } } };
  const texts = (/** @type {number} */ stiffness) => {
    const axles = Array.from({ length: 30 }, (_, index) => ({ position: index ** 2, load: 170, stiffness }));
    const rows = studySections({ train: { type: "axle_table", axles } }, "crossing", null, document).flatMap(({ groups }) => groups).flatMap((group) => group.rows);
    return Object.fromEntries(rows.map(({ pointer, text }) => [pointer, text]));
  };
  assert.equal(texts(0)["/train/axles/stiffness"], "follows from the bounce frequency");
  assert.equal(texts(2)["/train/axles/stiffness"], "30 × 2");
  assert.equal(texts(0)["/train/axles/load"], "30 × 170");
  assert.equal(texts(0)["/train/axles/position"], "0, 1, 4, …, 841 (30 values)");
});

test("a row of units below the headings is none of the axles, a row with a number is", () => {
  assert.deepEqual(paste("x\tP\n[m]\t[kN]\n0\t170\n2\t160").rows, [axle(0), axle(2, 160e3)]);
  const { rows, refused } = paste("x\tP\nhead\t170\n2\t160");
  assert.deepEqual(rows, [axle(0), axle(2, 160e3)]);
  assert.deepEqual(refused, ["position, row 1: Give a number, for example 0.25."]);
});

test("cells that are no numbers are named by their row, the others are taken", () => {
  const { rows, refused } = paste("0;170\n2,5;heavy\n-1;160");
  assert.deepEqual(refused, ["load, row 2: Give a number, for example 0.25.", "position, row 3: Must be at least 0 m."]);
  assert.deepEqual(rows.map((row) => row.position), [0, 2.5, 2.5]);
  assert.equal(rows[2].load, 160e3);
});

test("no more rows than a table may have", () => {
  const text = Array.from({ length: 205 }, (_, index) => `${2 * index}\t170`).join("\n");
  const { rows, refused } = paste(text);
  assert.equal(rows.length, 200);
  assert.deepEqual(refused, ["More than 200 rows"]);
});

test("a table goes with the viaduct, and its program has every axle", () => {
  const templates = [
    { name: "a", study: { viaduct: { type: "u_girder" } } },
    { name: "b", study: { viaduct: { type: "beam" } } },
  ];
  const train = table(0, 2.5);
  assert.equal(studyAround("train", train, templates).viaduct.type, "u_girder");
  const python = exportsOf("crossing").find((item) => item.name === "python");
  const text = python.text({ study: { train }, kind: "crossing", origin: "http://127.0.0.1" });
  assert.ok(text.includes('"position": 2.5'), text);
  assert.equal(titleOf("axle_table"), "Table of axles");
});
