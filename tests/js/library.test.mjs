import assert from "node:assert/strict";
import { test } from "node:test";

import { axleGroups, axleLoads } from "../../static/js/axle-loads.js";
import { Drafts } from "../../static/js/drafts.js";
import { LibraryEdit } from "../../static/js/library-edit.js";
import { profileOf } from "../../static/js/irregularity-profile.js";
import { copyOf, entryOf, importable, kindOf, studyAround } from "../../static/js/library-parts.js";

const type = (name, articulation, carbody, bogie, wheelset, leading, trailing) => ({
  name,
  articulation,
  carbody_mass: carbody,
  bogie_mass: bogie,
  wheelset_mass: wheelset,
  leading_distance: leading,
  trailing_distance: trailing,
});
/** Neves (2016), tables 6.1 to 6.3. */
const KHST = {
  type: "articulated",
  passenger_orientation: "leading_outwards",
  vehicle_types: [
    type("power", "none", 54960, 2420, 2050, 7, 7),
    type("trailer", "trailing_end", 39770, 2514, 2050, 5.977, 12.723),
    type("car", "both_ends", 26950, 3050, 2000, 8.926, 9.774),
  ],
  consist: ["power", "trailer", ...Array(16).fill("car"), "trailer", "power"],
};

test("the axles of the KHST weigh what the source prints", () => {
  const loads = axleLoads(KHST);
  assert.equal(loads.length, 46);
  // Wheel loads of 8.500, 8.418, 8.462 and 8.194 t.
  const expected = new Map([
    [0, 17.0],
    [4, 16.836],
    [6, 16.924],
    [22, 16.388],
  ]);
  for (const [axle, load] of expected) assert.ok(Math.abs(loads[axle] / 1000 - load) < 2e-3, `axle ${axle + 1}: ${loads[axle]}`);
  const total = loads.reduce((sum, load) => sum + load, 0);
  assert.ok(Math.abs(total - 779818) < 1, `${total}`);
  assert.deepEqual(loads, loads.toReversed());
});

test("turned passenger cars load the central bogie otherwise", () => {
  const loads = axleLoads({ ...KHST, passenger_orientation: "leading_inwards" });
  assert.ok(Math.abs(loads[22] / 2000 - 8.806) < 2e-3);
});

test("trains that are not whole have no axles to weigh", () => {
  assert.deepEqual(axleLoads({ type: "articulated", consist: ["x"], vehicle_types: [] }), []);
  assert.deepEqual(axleLoads({ type: "articulated" }), []);
  assert.deepEqual(axleLoads({ type: "sprung_masses", mass: 5, count: 2 }), [5, 5]);
});

test("equal neighbours are grouped", () => {
  assert.deepEqual(axleGroups([5, 5, 6, 5]), [
    { first: 1, last: 2, load: 5 },
    { first: 3, last: 3, load: 6 },
    { first: 4, last: 4, load: 5 },
  ]);
});

test("a defect is as wide as its source prints", () => {
  for (const [k, width] of [
    [0.5, 12.1],
    [0.7, 8.7],
    [0.9, 6.7],
  ]) {
    const profile = profileOf({ type: "isolated", amplitude: 0.01, wave_number: k, position: 27, rail: "right" });
    assert.equal(profile.width.toFixed(1), width.toFixed(1));
    assert.equal(Math.max(...profile.r), 0.01);
    assert.match(profile.words, /10 mm high.*27 m on the right rail/);
  }
  assert.equal(profileOf({ type: "none" }), null);
  assert.equal(profileOf({ type: "isolated", amplitude: 0.01, wave_number: 0, position: 1 }), null);
});

test("a part is drawn with others that go with it", () => {
  const templates = [
    { study: { viaduct: { type: "u_girder" }, train: { type: "articulated" } } },
    { study: { viaduct: { type: "beam" }, train: { type: "sprung_masses" } } },
  ];
  assert.equal(studyAround("train", { type: "sprung_masses" }, templates).viaduct.type, "beam");
  assert.equal(studyAround("track", { type: "ballasted" }, templates).viaduct.type, "u_girder");
  assert.equal(studyAround("irregularity", { type: "none" }, templates).viaduct.type, "u_girder");
  assert.equal(kindOf("boats"), null);
});

test("remarks on figures that were changed are dropped", () => {
  const remarks = [
    { pointer: "/a/b", confidence: "assumed", text: "" },
    { pointer: "/c", confidence: "assumed", text: "" },
  ];
  const entry = { name: "n", source: "s", confidence: "", remarks, value: { a: { b: 2 }, c: 3 } };
  assert.deepEqual(entryOf(entry, { a: { b: 1 }, c: 3 }).remarks, [remarks[1]]);
  const copy = copyOf({ ...entry, id: "x", kind: "trains", built_in: true, created: null, changed: null });
  assert.deepEqual([copy.name, copy.source, copy.remarks.length], ["n (copy)", "Copy of n: s", 2]);
  assert.ok(!("id" in copy));
});

test("an import is a library, a list or one entry, and nothing else", () => {
  const item = { kind: "trains", name: "a", value: {} };
  for (const text of [JSON.stringify({ items: [item] }), JSON.stringify([item]), JSON.stringify(item)]) {
    assert.deepEqual(importable(text), { items: [item] });
  }
  assert.throws(() => importable("{"), /no JSON/);
  for (const text of ["[]", "3", "null", '{"study": {}}', '{"items": [1]}']) assert.throws(() => importable(text), /no entries/);
});

test("an entry that is edited is kept as a draft until it is saved or given up", () => {
  const kept = new Map();
  const drafts = new Drafts(() => ({ getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => void kept.set(key, value) }));
  const remark = (pointer) => ({ pointer, confidence: "C", text: "assumed" });
  const value = { type: "isolated", amplitude: 0.01, position: 5 };
  const item = { id: "a", kind: "irregularities", name: "Joint", source: "", confidence: "", built_in: false, value, remarks: [remark("/amplitude"), remark("/position")] };
  const templates = [{ name: "t", study: { viaduct: { type: "beam" }, irregularity: { type: "none" } } }];
  const first = new LibraryEdit(item, templates, drafts);
  assert.equal(first.resumed, null);
  first.write("name", "Bad joint ");
  first.set("/irregularity/amplitude", 0.02);
  const again = new LibraryEdit(item, templates, drafts);
  assert.notEqual(again.resumed, null);
  assert.equal(again.study.irregularity.amplitude, 0.02);
  assert.deepEqual([again.entry.name, again.entry.remarks.map(({ pointer }) => pointer)], ["Bad joint", ["/position"]]);
  assert.equal(new LibraryEdit({ ...item, id: "b" }, templates, drafts).resumed, null, "every entry has its own");
  again.set("/irregularity", null, { tag: "isolated", initial: { type: "isolated" }, complete: false, help: "" });
  assert.equal(again.content.value.amplitude, 0.01, "the kind that it had comes back as it was saved");
  again.restart();
  assert.equal(new LibraryEdit(item, templates, drafts).resumed, null);
});
