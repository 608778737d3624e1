import assert from "node:assert/strict";
import { test } from "node:test";

import { changeText, chosenChannel, inputName, inputText, inputTexts, resultGroups, runNames, runsOf } from "../../static/js/compare-words.js";

const run = (id, changes = {}) => ({ id, job: "j", name: "KHST", kind: "crossing", index: 0, runs: 1, state: "done", parameters: { speed: 100 }, has_histories: true, ...changes });

test("the address names the runs, the baseline first", () => {
  assert.deepEqual(runsOf(new URLSearchParams("runs=a,b,c&base=b")), ["b", "a", "c"]);
  assert.deepEqual(runsOf(new URLSearchParams("runs=a,b,a,,<x>&base=z")), ["a", "b"]);
  assert.deepEqual(runsOf(new URLSearchParams("")), []);
  assert.equal(runsOf(new URLSearchParams({ runs: Array.from({ length: 20 }, (_, i) => `r${i}`).join() })).length, 12);
});

test("runs have names that tell them apart", () => {
  assert.deepEqual(runNames([run("a1"), run("b2", { name: "Beam" })]), ["KHST, 360 km/h", "Beam, 360 km/h"]);
  const sweep = [run("a", { runs: 2 }), run("b", { runs: 2, parameters: { speed: 50 } })];
  assert.deepEqual(runNames(sweep), ["360 km/h", "180 km/h"]);
  assert.deepEqual(runNames([run("abcde"), run("fghij")]), ["KHST, 360 km/h (abcd)", "KHST, 360 km/h (fghi)"]);
  assert.deepEqual(runNames([run("a", { kind: "modes", parameters: {} })]), ["KHST, modes"]);
});

test("inputs are named with section and place", () => {
  assert.deepEqual(inputName("/track/pad_stiffness"), { section: "Track", name: "Pad stiffness" });
  assert.deepEqual(inputName("/train/vehicle_types/0/carbody_mass"), { section: "Train", name: "Vehicle type 1: carbody mass" });
  assert.deepEqual(inputName("/train/damper_heights/upper"), { section: "Train", name: "Damper heights: upper" });
  assert.deepEqual(inputName("/mesh_level"), { section: "Study", name: "Mesh level" });
});

test("values are shown in display units", () => {
  const unit = { symbol: "m/s", display: "km/h", scale: 3.6 };
  assert.equal(inputText(120, unit), "432 km/h");
  assert.equal(inputText([100], unit), "360 km/h");
  assert.equal(inputText(null, unit), "–");
  assert.equal(inputText(true, null), "yes");
  assert.equal(inputText("linear_hertz", null), "linear hertz");
  assert.equal(inputText(["power_car", "car", "car"], null).includes("power car"), true);
});

test("changes are percentages with a sign, large ones factors", () => {
  assert.equal(changeText(0.0312), "+3.1 %");
  assert.equal(changeText(-0.25), "−25 %");
  assert.equal(changeText(0), "same");
  assert.equal(changeText(24.6), "+25 times");
  assert.equal(changeText(null), "");
});

test("results are grouped, unknown groups last, and what only one run has after them", () => {
  const result = (name, group, values = [1, 2]) => ({ name, group, unit: null, values, changes: [0], remarks: [""] });
  const groups = resultGroups([result("a", "strange_things"), result("b", "deck"), result("c", "verdict", [1, null]), result("d", "deck", [null, 1])]);
  assert.deepEqual(
    groups.map(({ title, results }) => [title, results.length]),
    [
      ["Verdicts", 1],
      ["Deck", 1],
      ["Strange things", 1],
      ["What only one run has", 1],
    ],
  );
});

test("the first history is what a verdict looks at", () => {
  const channels = ["wheel 01/contact force", "mid-span 1, axis/acceleration", "mid-span 2, axis/acceleration"].map((name) => ({ name, group: "" }));
  assert.equal(chosenChannel(channels, null), "mid-span 2, axis/acceleration");
  assert.equal(chosenChannel(channels, "wheel 01/contact force"), "wheel 01/contact force");
  assert.equal(chosenChannel([], "x"), "");
});

test("long lists that are shortened alike still say where they differ", () => {
  const metres = { symbol: "m", display: "mm", scale: 1000 };
  const level = Array.from({ length: 60 }, (_, index) => 1e-4 * ((index * 7) % 23));
  const bumped = level.map((value, index) => (index === 16 ? 0.0031 : value));
  const twice = bumped.map((value, index) => (index === 30 ? 0.004 : value));
  const [first, second, third, fourth] = inputTexts([level, bumped, twice, null], metres);
  assert.equal(second, `${first}; row 17: 3.1 mm`);
  assert.equal(third, `${first}; row 17: 3.1 mm, 1 more`);
  assert.equal(fourth, "–");
  assert.deepEqual(inputTexts([[1, 2], [1, 2]], null), ["1, 2", "1, 2"]);
});
