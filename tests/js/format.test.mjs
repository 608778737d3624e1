// What people read: numbers, durations, units.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ago, besideLimit, bytes, duration, label, number, quantity, remaining, roughly, speed, stateText, unitText } from "../../static/js/format.js";

test("numbers keep their significant figures and group thousands", () => {
  assert.equal(number(3.9812), "3.98");
  assert.equal(number(-0.5), "−0.5");
  assert.equal(number(12345.6, 3), "12\u202f346");
  assert.equal(number(110000, 2), "110\u202f000");
  assert.equal(number(1.5e-5), "1.50e−5".replace("e−5", "e-5").replace("-", "−"));
  assert.equal(number(0), "0");
  assert.equal(number(null), "–");
  assert.equal(number(Number.NaN), "–");
});

test("a stored value is shown in its display unit", () => {
  assert.equal(quantity(-0.002, { symbol: "m", display: "mm", scale: 1000 }), "−2 mm");
  assert.equal(quantity(3.5, "m/s2"), "3.5 m/s²");
  assert.equal(unitText({ symbol: "1", display: "", scale: 1 }), "");
  assert.equal(speed(120), "432 km/h");
  assert.equal(speed(100 / 3.6), "100 km/h");
});

test("durations are ones that people plan with", () => {
  assert.equal(duration(0.2), "under 1 s");
  assert.equal(duration(62), "62 s");
  assert.equal(duration(125), "2 min 5 s");
  assert.equal(duration(1800), "30 min");
  assert.equal(duration(5400), "1 h 30 min");
  assert.equal(remaining([30, 62]), "30 to 60 s left");
  assert.equal(remaining([115, 175]), "2 to 3 min left");
  assert.equal(remaining([62, 185]), "60 s to 3 min left");
  assert.equal(remaining([41, 42]), "about 40 s left");
  assert.equal(remaining([0.2, 0.9]), "a moment left");
  assert.equal(remaining(null), "");
  assert.equal(roughly(337), "about 6 min");
  assert.equal(roughly(82), "about 80 s");
  assert.equal(roughly(undefined), "–");
});

test("sizes, ages, states and labels", () => {
  assert.equal(bytes(1.5e9), "1.5 GB");
  assert.equal(bytes(0), "0 B");
  assert.equal(ago("2024-01-01T00:00:00Z", Date.UTC(2024, 0, 1, 0, 5)), "5 min ago");
  assert.equal(ago("2024-01-01T00:00:00", Date.UTC(2024, 0, 1, 3)), "3 h ago");
  assert.equal(stateText("out_of_memory"), "Out of memory");
  assert.equal(label("line_speed"), "Line speed");
});

test("a verdict's value never reads as its limit", () => {
  assert.equal(besideLimit(9.4029, 3.5), "9.40");
  assert.equal(besideLimit(3.5003, 3.5), "3.5003");
  assert.equal(besideLimit(3.5, 3.5), "3.50");
});
