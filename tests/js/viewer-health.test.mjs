// What the 3D view is asked for, when it needs help, and how calmly the address is written.
import assert from "node:assert/strict";
import { test } from "node:test";
import { AddressWriter } from "../../static/js/address-writer.js";
import { themed } from "../../static/js/chart-theme.js";
import { isActive, shownRun, tabTitle } from "../../static/js/job-words.js";
import { lookOf } from "../../static/js/view-address.js";
import { ViewerHealth } from "../../static/js/viewer-health.js";
import { looksOf } from "../../static/js/viewer-looks.js";

const look = (text) => lookOf(new URLSearchParams(text));

test("a run is asked only for what it can show", () => {
  const state = { available_colours: ["none", "displacement"], available_layers: ["slab", "rails"], camera: "overview", modal: false };
  const asked = looksOf(look("colour=peak&camera=side&hidden=rails&place=1,2,3&mode=4"), 50, state);
  assert.deepEqual(asked, { scale: 50, camera: "side", place: [1, 2, 3], layers: ["slab"] });
  assert.deepEqual(looksOf(look("mode=4"), null, { ...state, modal: true }), { mode: 3, layers: ["slab", "rails"] });
  assert.deepEqual(looksOf(look("scale=7&colour=displacement"), 50, null), { scale: 7 });
});

test("what is missing three looks long is mended, a pause is told once", () => {
  const health = new ViewerHealth();
  const plain = { clients: 1, colour: "peak", smooth: true, paused: "" };
  const looks = [0, 1, 2].map(() => health.examine(plain, false).simplify);
  assert.deepEqual(looks, [false, false, true]);
  assert.equal(health.examine(plain, null).simplify, false);
  const alone = [0, 1, 2].map(() => health.examine({ ...plain, clients: 0 }, false).wake);
  assert.deepEqual(alone, [false, false, true]);
  const told = ["another plays", "another plays", ""].map((paused) => health.examine({ ...plain, paused }, true));
  assert.deepEqual(told.map(({ halted }) => halted), [true, false, false]);
  assert.deepEqual(told.map(({ resumed }) => resumed), [false, false, true]);
});

test("the address is written at once, then at a calm pace, and never another page's", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const written = [];
  let page = "#/jobs/a";
  const writer = new AddressWriter((key, value) => written.push([key, value]), () => page);
  for (let step = 0; step < 5; step += 1) writer.write({ t: String(step) });
  assert.deepEqual(written, [["t", "0"]]);
  t.mock.timers.tick(200);
  assert.deepEqual(written, [["t", "0"], ["t", "4"]]);
  writer.write({ t: "5" });
  page = "#/jobs";
  t.mock.timers.tick(200);
  writer.write({ t: "6" });
  writer.close();
  writer.write({ t: "7" });
  t.mock.timers.tick(200);
  assert.equal(written.length, 2);
});

test("the run that is shown: chosen, proposed, begun, first", () => {
  const runs = [{ id: "a" }, { id: "b", progress: { step: 3 } }, { id: "c" }];
  assert.equal(shownRun(runs, "c", "a"), "c");
  assert.equal(shownRun(runs, "other", "a"), "a");
  assert.equal(shownRun(runs, "", ""), "b");
  assert.equal(shownRun([], "x", "y"), "");
  assert.ok(isActive({ state: "queued" }) && !isActive({ state: "failed" }));
  assert.equal(tabTitle({ state: "running", name: "A", progress: { fraction: 0.257 } }), "25 % · A · Trainbridge");
});

test("a callout above its peak does not cover the legend", () => {
  const figure = (ay) => ({ data: [], layout: { annotations: [{ showarrow: true, ax: 40, ay, text: "9.4<br>here" }, { showarrow: false, text: "span 1: not judged" }] } });
  const theme = { dark: false, ink: "#000", soft: "#111", line: "#222", paper: "#fff", type: "sans" };
  const legend = (ay, narrow) => themed(figure(ay), theme, narrow).layout.legend.y;
  assert.ok(legend(-34, false) > legend(-34, true));
  assert.ok(legend(-34, true) > legend(34, true));
  const low = { ...figure(-34).layout, annotations: [{ showarrow: true, ax: 40, ay: -34, y: -2, text: "9.4<br>here" }], yaxis: { range: [-2, 2] } };
  assert.equal(themed({ data: [], layout: low }, theme, false).layout.legend.y, legend(34, false), "far below the legend it takes no room");
  const words = themed(figure(-34), theme, true).layout.annotations.map(({ text }) => text);
  assert.deepEqual(words, ["9.4", "span 1"]);
});
