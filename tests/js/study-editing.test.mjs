// What editing a study does: ranges, steps back, differences, pasted tables, drafts, advice.
import assert from "node:assert/strict";
import { test } from "node:test";
import { differences, same } from "../../static/js/difference.js";
import { Drafts } from "../../static/js/drafts.js";
import { entered, shown } from "../../static/js/entry.js";
import { History } from "../../static/js/history.js";
import { asTabs, cellsOf, isTable, listOf, numberOf, withoutHeadings } from "../../static/js/paste.js";
import { condensed, counted, expanded, named } from "../../static/js/ranges.js";
import { advised } from "../../static/js/remedy.js";
import { pasted, turn } from "../../static/js/table-edit.js";

const plain = { kind: "number", unit: null, minimum: null, maximum: null, above: false, below: false, options: [], most: null, whole: false, optional: false };
const speeds = { ...plain, kind: "list", unit: { symbol: "m/s", display: "km/h", scale: 3.6 }, minimum: 0, above: true, maximum: 200, most: 500 };

test("a range of speeds is typed and shown as a range", () => {
  const entry = entered("200:400:10", speeds);
  assert.equal(entry.value.length, 21);
  assert.equal(entry.value[0], 55.5555555556);
  assert.equal(shown(entry.value, speeds), "200:400:10");
  assert.equal(shown(entered("200 : 230 : 10; 432,5", speeds).value, speeds), "200:230:10, 432.5");
  assert.equal(shown(entered("432, 300, 216", speeds).value, speeds), "432, 300, 216");
});

test("a range ends where a step meets the end, and runs either way", () => {
  assert.deepEqual(expanded("0:1:0.3").values, [0, 0.3, 0.6, 0.9]);
  assert.deepEqual(expanded("0.1:0.3:0.1").values, [0.1, 0.2, 0.3]);
  assert.deepEqual(expanded("400:370:10").values, [400, 390, 380, 370]);
  assert.deepEqual(expanded("5:5:1").values, [5]);
});

test("the unit that stands beside an input may be typed too", () => {
  assert.equal(shown(entered("200:400:10 km/h", speeds).value, speeds), "200:400:10");
  assert.equal(entered("7.2 m", { ...plain, unit: { symbol: "m", display: "", scale: 1 } }).value, 7.2);
  assert.match(entered("7.2 mm", { ...plain, unit: { symbol: "m", display: "m", scale: 1 } }).error, /number/);
});

test("a range that cannot be one says why", () => {
  assert.match(expanded("200:400").error, /start:end:step/);
  assert.match(expanded("a:b:c").error, /start:end:step/);
  assert.match(expanded("1:2:0").error, /cannot be 0/);
  assert.match(expanded("0:1:1e-9").error, /more than 1000/);
  assert.match(entered("1:600:1", speeds).error, /600 values; give at most 500/);
  assert.match(entered("200:800:100", speeds).error, /^800: Must be at most 720 km\/h/);
});

test("only four or more equal steps become a range", () => {
  assert.equal(condensed([16.5, 21, 21]), "16.5, 21, 21");
  assert.equal(condensed([1, 2, 3]), "1, 2, 3");
  assert.equal(condensed([1, 2, 3, 4, 9]), "1:4:1, 9");
  assert.deepEqual(expanded(condensed([4, 3, 2, 1])).values, [4, 3, 2, 1]);
  assert.equal(condensed([]), "");
});

test("a consist is written with counts and read back", () => {
  const consist = ["power_car", ...Array(16).fill("passenger_car"), "power_car"];
  assert.equal(counted(consist), "power_car, 16 × passenger_car, power_car");
  assert.deepEqual(named(counted(consist)), consist);
  assert.deepEqual(named("2x a, 3 * b; c\nd"), ["a", "a", "b", "b", "b", "c", "d"]);
  assert.equal(named("999999999 x a").length, 1000);
});

test("typing is one step back, everything else its own", () => {
  const history = new History("");
  for (const [index, text] of ["4", "43", "432"].entries()) history.push(text, "/speed", index * 200);
  history.push("432!", "/name", 500);
  history.push("432?", "/name", 5000);
  assert.equal(history.undo(), "432!");
  assert.equal(history.undo(), "432");
  assert.equal(history.undo(), "");
  assert.equal(history.undo(), null);
  assert.equal(history.redo(), "432");
  history.push("other", "", 6000);
  assert.equal(history.redo(), null, "a new step forgets what was undone");
  assert.equal(history.undo(), "432");
});

test("differences are as deep as the shapes agree", () => {
  const before = { sweep: { speeds: [120] }, irregularity: { type: "none" }, train: { cars: [{ mass: 1 }, { mass: 2 }] } };
  const after = { sweep: { speeds: [120, 130] }, irregularity: { type: "isolated", amplitude: 1 }, train: { cars: [{ mass: 1 }, { mass: 3 }] } };
  assert.deepEqual(differences(before, after), ["/sweep/speeds", "/irregularity", "/train/cars/1/mass"]);
  assert.deepEqual(differences(before, structuredClone(before)), []);
  assert.ok(same({ a: 1, b: [2] }, { b: [2], a: 1 }));
  assert.ok(!same([], {}));
  assert.ok(!same({ a: undefined }, { b: 1 }));
});

test("a spreadsheet's cells keep their decimal commas", () => {
  assert.deepEqual(cellsOf("a\t1,5\r\nb\t2,5\r\n"), [["a", "1,5"], ["b", "2,5"]]);
  assert.deepEqual(cellsOf("1,5;2\n3;4"), [["1,5", "2"], ["3", "4"]]);
  assert.deepEqual(cellsOf('x,y\n"1,5",2'), [["x", "y"], ["1,5", "2"]]);
  assert.deepEqual(cellsOf('"said ""so"""\tb'), [['said "so"', "b"]]);
  assert.deepEqual(["1 234,5", "1,234.5", "1.234,5", "−3", "1e-3", "", "x"].map(numberOf), [1234.5, 1234.5, 1234.5, -3, 0.001, NaN, NaN]);
  assert.deepEqual(withoutHeadings([["x", "mass"], ["a", "2"]], [false, true]), [["a", "2"]]);
  assert.ok(isTable("1\n2") && isTable("1\t2") && !isTable("1.5") && !isTable("432\n"));
  assert.equal(listOf("Speed\n200\n300,5\n"), "200, 300.5");
  assert.equal(listOf("power_car\nother_car"), "power_car, other_car");
  assert.deepEqual(cellsOf(asTabs([["a", 1], ["b", 2]])), [["a", "1"], ["b", "2"]]);
});

test("a pasted block fills the table from its cell, and adds rows", () => {
  const columns = [{ ...plain, pointer: "/x", label: "x" }, { ...plain, pointer: "/load", label: "Load", unit: { symbol: "N", display: "kN", scale: 1e-3 }, minimum: 0 }];
  const limits = { most: 3, blank: { x: 0, load: 0 } };
  const { rows, refused } = pasted([{ x: 0, load: 1 }], columns, cellsOf("x\tload\n0\t170\n3\t170,5"), { row: 0, column: 0 }, limits);
  assert.deepEqual(rows, [{ x: 0, load: 170000 }, { x: 3, load: 170500 }]);
  assert.deepEqual(refused, []);
  const bad = pasted(rows, columns, [["-1"], ["2"], ["3"], ["4"]], { row: 1, column: 1 }, limits);
  assert.equal(bad.rows[1].load, 170500, "a refused cell stays as it was");
  assert.equal(bad.rows.length, 3);
  assert.match(bad.refused[0], /Load, row 2: Must be at least 0 kN/);
  assert.match(bad.refused[1], /More than 3 rows/);
});

test("a table on its side takes a block on its side", () => {
  const columns = Array.from({ length: 8 }, (_, index) => ({ ...plain, pointer: `/${index}`, label: String(index) }));
  const row = Object.fromEntries(columns.map((_, index) => [index, index]));
  const { rows } = pasted([row, row], columns, [["10", "20"], ["11", "21"]], { row: 0, column: 2 }, { most: 5, blank: row });
  assert.deepEqual([rows[0][2], rows[0][3], rows[1][2], rows[1][3]], [10, 11, 20, 21]);
  assert.deepEqual(turn([["a", "b"], ["c"]]), [["a", "c"], ["b", ""]]);
});

test("drafts outlive the page, the oldest give way, and a broken storage breaks nothing", () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => void kept.set(key, value) };
  const drafts = new Drafts(() => storage);
  for (let index = 0; index < 20; index += 1) drafts.keep(`template ${index}`, { value: { name: String(index) }, saved: index });
  assert.equal(drafts.get("template 19").value.name, "19");
  assert.equal(drafts.get("template 0"), null);
  drafts.keep("template 19", null);
  assert.equal(drafts.get("template 19"), null);
  drafts.keep("large", { value: { text: "x".repeat(2_000_000) }, saved: 1 });
  assert.ok([...kept.values()].join("").length <= 1_000_000);
  kept.set("trainbridge.drafts", "no JSON");
  assert.equal(drafts.get("template 3"), null);
  const full = new Drafts(() => ({ getItem: () => null, setItem: () => { throw new Error("full"); } }));
  full.keep("a", { value: {}, saved: 0 });
  const refused = new Drafts(() => { throw new Error("SecurityError"); });
  refused.keep("a", { value: {}, saved: 0 });
  assert.equal(refused.get("a"), null);
});

test("the value that advice names can be used as it stands", () => {
  const step = { ...plain, unit: { symbol: "s", display: "ms", scale: 1000 }, minimum: 1e-7, maximum: 0.1 };
  const length = { ...plain, unit: { symbol: "m", display: "m", scale: 1 }, minimum: 0, maximum: 5000 };
  const say = (remedy, field) => advised({ pointer: "", reason: "", remedy }, field);
  assert.equal(say("Use at most 0.00125 s.", step), 0.00125);
  assert.equal(say("Use at most 1.25 ms.", step), 0.00125);
  assert.equal(say("Use at most 1e-05 s, or a lower cut-off.", step), 1e-5);
  assert.equal(say("Use at least 526 m, or 0 to let it follow from the train.", length), 526);
  assert.equal(say("Use 66 m or more.", length), 66);
  assert.equal(say("Place it at x = -12.5 m or beyond.", { ...length, minimum: -100 }), -12.5);
  assert.equal(say("Use at least 9000 m.", length), null, "outside the field's own bounds");
  assert.equal(say("Use at most 3 kg.", length), null);
  assert.equal(say("Make the defect shorter.", length), null);
  const level = { ...plain, kind: "choice", options: ["coarse", "standard"] };
  assert.equal(say("Use the coarse mesh, or install pypardiso.", level), "coarse");
  assert.equal(say("Confirm the verdict on the standard mesh.", level), "standard");
  assert.equal(say("Choose one of these.", level), null);
});
