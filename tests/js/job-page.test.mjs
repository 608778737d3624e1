// The job page's pure parts: address, tabs, keys, channels, filters, words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { found, fitting, groupsOf } from "../../static/js/channel-choice.js";
import { isTimed } from "../../static/js/chart-plot.js";
import { comparable, matches, statesOf } from "../../static/js/job-filter.js";
import { tabsOf } from "../../static/js/job-tabs.js";
import { logLines, namedField } from "../../static/js/job-words.js";
import { momentsOfInterest } from "../../static/js/moment.js";
import { KEY_WORDS, actionOf } from "../../static/js/time-keys.js";
import { troubleWords } from "../../static/js/trouble.js";
import { addressOf, lookOf } from "../../static/js/view-address.js";

const look = {
  run: "a1",
  tab: "slab-map",
  time: 3.4842,
  window: { from: 1, to: 2.5 },
  place: [27, -0.7175, 1.335],
  mode: 4,
  colour: "acceleration",
  scale: 200,
  camera: "section",
  pose: { position: [-21.5, -40.125, 12], look_at: [27, 0, -0.003], fov: null },
  hidden: ["rails", "train"],
  channels: { displacement: ["mid-span 2, axis/displacement"], spectrum: ["odd;name|with%/x", "b"] },
  variants: { "slab-map": "raw", spectrum: "hann" },
};

test("what an address says is what it was made from", () => {
  const address = Object.entries(addressOf(look)).filter(([, value]) => value !== null);
  const query = new URLSearchParams(new URLSearchParams(address).toString());
  assert.deepEqual(lookOf(query), look);
});

test("an address keeps nothing that is not looked at, and forgives bad spelling", () => {
  assert.deepEqual(Object.values(addressOf(lookOf(new URLSearchParams()))).filter((value) => value !== null), []);
  const odd = lookOf(new URLSearchParams("t=soon&from=3&to=1&place=1,2&mode=-3&channels=nothing&variant=x"));
  assert.deepEqual([odd.time, odd.window, odd.place, odd.mode], [null, null, null, 1]);
  assert.deepEqual([odd.channels, odd.variants], [{}, {}]);
});

test("tabs hold the figures that a run has; a sweep has its own", () => {
  const figures = [{ name: "slab-acceleration" }, { name: "slab-map" }, { name: "spectrum" }];
  const tabs = tabsOf({ kind: "crossing", runs: [{}] }, figures);
  assert.deepEqual(tabs.map((tab) => tab.id), ["overview", "accelerations", "slab-map", "inputs", "log", "files"]);
  assert.deepEqual(tabs[1].figures.map((figure) => figure.name), ["slab-acceleration", "spectrum"]);
  assert.ok(tabsOf({ kind: "crossing", runs: [{}, {}] }, figures).some((tab) => tab.id === "sweep"));
  assert.equal(tabsOf({ kind: "modes", runs: [{}] }, figures)[0].title, "Modes");
});

const within = (selector) => ({ closest: (asked) => (asked.includes(selector) ? {} : null) });

test("keys act unless a control needs them itself", () => {
  const press = (key, more = {}) => ({ key, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, ...more });
  assert.equal(actionOf(press(" "), null), "toggle");
  assert.equal(actionOf(press(" "), within("button")), null);
  assert.equal(actionOf(press("ArrowRight", { shiftKey: true }), null), "leap-forward");
  assert.equal(actionOf(press("ArrowRight"), within("[role=tab]")), null);
  assert.equal(actionOf(press("p"), within("textarea")), null);
  assert.equal(actionOf(press("p", { ctrlKey: true }), null), null);
  assert.equal(actionOf(press("x"), null), null);
  assert.ok(KEY_WORDS.length >= 6);
});

test("channels are found by words and group, and fit by quantity", () => {
  const channel = (name, group) => ({ name, title: name, group, unit: {} });
  const all = [channel("wheel 01 left/contact force", "wheel"), channel("wheel 12 left/contact force", "wheel"), channel("mid-span 2, axis/acceleration", "deck")];
  assert.deepEqual(found(all, { text: "12 wheel", group: "" }).map((item) => item.name), ["wheel 12 left/contact force"]);
  assert.equal(found(all, { text: "", group: "deck" }).length, 1);
  assert.equal(fitting(all, { drawn: ["wheel 01 left/contact force"], any: false }).length, 2);
  assert.equal(fitting(all, { drawn: ["wheel 01 left/contact force"], any: true }).length, 3);
  assert.deepEqual(groupsOf(all), ["deck", "wheel"]);
});

test("the list of jobs shows what was asked for", () => {
  const job = { state: "timed_out", name: "KHST over Alverca", kind: "crossing", runs: [{ id: "a", state: "done" }, { id: "b", state: "failed" }] };
  assert.ok(matches(job, { state: "failed", name: "alverca" }));
  assert.ok(!matches(job, { state: "done", name: "" }));
  assert.deepEqual(statesOf(""), []);
  assert.deepEqual(comparable(job), ["a"]);
  assert.deepEqual(comparable({ ...job, kind: "modes" }), []);
});

test("a failure names the input at fault and how far it came", () => {
  const detail = "integration.time_step = 0.05: is longer than a bay. Give less.";
  const words = troubleWords({ state: "failed", error: { detail }, progress: { step: 10, steps: 100, simulated_time: 1.25 } });
  assert.equal(words.field, "/integration/time_step");
  assert.match(words.stable, /t = 1.250 s, step 10 of 100/);
  assert.equal(namedField("train.vehicle_types[2].carbody_mass = 0: is 0"), "/train/vehicle_types/2/carbody_mass");
  assert.equal(namedField("No contact at t = 1 s."), "");
});

test("a log is read line by line", () => {
  const [first, second] = logLines("2026-01-01T00:00:00+00:00  job  queued\n2026-01-01T00:00:01+00:00  run 0 (ab)  checkpoint of step 5 stored\n");
  assert.deepEqual([first.run, first.words], ["job", "queued"]);
  assert.deepEqual([second.run, second.words], ["run 1", "checkpoint of step 5 stored"]);
});

test("moments are named, the one that decides first", () => {
  const peaks = {
    "mid-span 1, axis/displacement": { least: -2, time_of_least: 0.7 },
    "mid-span 1, left rail/displacement": { least: -2, time_of_least: 0.8 },
    "wheel 01 left/contact force": { least: 5, time_of_least: 2 },
    "wheel 02 left/contact force": { least: 0, time_of_least: 3 },
  };
  const moments = momentsOfInterest({ verdicts: [{ time: 3.4, raw: { time: 3.8 } }], summary: { peaks } });
  assert.deepEqual(moments.map((moment) => moment.time), [3.4, 3.8, 0.7, 3]);
  assert.equal(moments.at(-1).words, "wheel 02 left loses contact");
  const pulled = { "wheel 04/contact force": { least: -336922, time_of_least: 0.86 } };
  assert.equal(momentsOfInterest({ verdicts: [], summary: { peaks: pulled } }).at(-1).words, "wheel 04 pulls most");
});

test("only a figure over time has the time's cursor", () => {
  const over = (text) => ({ layout: { xaxis: { title: { text } } } });
  assert.ok(isTimed(over("time [s]")));
  assert.ok(!isTimed(over("frequency [Hz]")));
  assert.ok(!isTimed({ layout: {} }));
});
