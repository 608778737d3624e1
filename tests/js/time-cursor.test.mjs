// The page's one time: play, pause, bounds, and no jump after a gap.
import assert from "node:assert/strict";
import { test } from "node:test";
import { TimeCursor } from "../../static/js/time-cursor.js";

function cursor() {
  const made = new TimeCursor();
  made.setRange(0, 2);
  return made;
}

test("time runs at the rate while playing, and not otherwise", () => {
  const time = cursor();
  time.tick(0);
  assert.equal(time.time, 0);
  time.play();
  time.tick(1000);
  time.tick(1100);
  assert.ok(Math.abs(time.time - 0.01) < 1e-12);
  time.pause();
  time.tick(1200);
  assert.ok(Math.abs(time.time - 0.01) < 1e-12);
});

test("a tab that slept goes on where it was", () => {
  const time = cursor();
  time.setRate(1);
  time.play();
  time.tick(0);
  time.tick(60_000);
  assert.equal(time.time, 0.25);
});

test("it stops at the end and starts again from the beginning", () => {
  const time = cursor();
  time.setRate(1);
  time.seek(1.95);
  time.play();
  time.tick(0);
  time.tick(200);
  assert.equal(time.time, 2);
  assert.equal(time.playing, false);
  time.play();
  assert.equal(time.time, 0);
});

test("a seek stays inside the run and tells everyone why", () => {
  const time = cursor();
  const reasons = [];
  time.addEventListener("change", (event) => reasons.push([event.detail.reason, event.detail.time]));
  time.seek(5);
  time.seek(Number.NaN);
  time.seek(-1);
  assert.deepEqual(reasons, [["seek", 2], ["seek", 0]]);
});

test("a run without length cannot play", () => {
  const time = new TimeCursor();
  time.play();
  assert.equal(time.playing, false);
});

test("a step goes to the next picture and stops the play", () => {
  const time = cursor();
  time.interval = 0.01;
  time.seek(0.503);
  time.play();
  time.step(1);
  assert.equal(time.playing, false);
  assert.ok(Math.abs(time.time - 0.51) < 1e-12);
  time.step(-10);
  assert.ok(Math.abs(time.time - 0.41) < 1e-12);
});

test("a mode swings on and on", () => {
  const time = cursor();
  time.setRange(0, 1);
  time.looping = true;
  time.setRate(1);
  time.seek(0.95);
  time.play();
  time.tick(0);
  time.tick(200);
  assert.ok(time.playing);
  assert.ok(Math.abs(time.time - 0.15) < 1e-12);
});

test("faster and slower go through the usual rates and stay inside them", () => {
  const time = cursor();
  time.changeRate(-1);
  assert.equal(time.rate, 0.05);
  for (let press = 0; press < 9; press += 1) time.changeRate(1);
  assert.equal(time.rate, 1);
});
