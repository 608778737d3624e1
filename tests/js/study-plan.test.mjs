// The form holds every field of the schema: unions, tables, optional parts, and nothing twice.
import assert from "node:assert/strict";
import { test } from "node:test";
import { planOf, pointersOf } from "../../static/js/form-plan.js";
import { completed, tagKey } from "../../static/js/schema.js";
import { folded, sectionsOf } from "../../static/js/sections.js";
import { words } from "../../static/js/titles.js";

const length = { type: "number", minimum: 0, unit: { symbol: "m", display: "m", scale: 1 } };
const law = (tag, properties, required) => ({ type: "object", properties: { law: { type: "string", const: tag, default: tag }, ...properties }, required });
const document = {
  components: {
    schemas: {
      Axle: { type: "object", properties: { x: { ...length, default: 0 }, load: { type: "number", default: 1 } } },
      Linear: law("linear", { stiffness: { type: "number", default: 5 } }),
      Rigid: law("rigid", {}),
    },
  },
};
const ref = (name) => ({ $ref: `#/components/schemas/${name}` });
const study = {
  type: "object",
  properties: {
    axles: { type: "array", items: ref("Axle"), minItems: 1, maxItems: 9, description: "Axles." },
    profile: { type: "array", items: { type: "array", prefixItems: [length, { type: "number", title: "r" }], minItems: 2, maxItems: 2 } },
    law: { anyOf: [ref("Linear"), ref("Rigid")], description: "Law." },
    stop: { anyOf: [ref("Rigid"), { type: "null" }], default: null },
    parts: { type: "array", items: { anyOf: [ref("Linear"), ref("Rigid")] } },
    limit: { anyOf: [{ type: "number", minimum: 0 }, { type: "null" }], default: null },
    names: { type: "array", items: { type: "string" } },
  },
};
const value = { axles: [{ x: 0, load: 3 }], profile: [[0, 1], [2, 3]], law: { law: "linear", stiffness: 5 }, stop: null, parts: [{ law: "rigid" }, { law: "linear", stiffness: 1 }], limit: null, names: ["a"] };
const plan = planOf(study, value, "", document);
const node = (pointer) => plan.children.find((item) => item.pointer === pointer);

test("lists of things and of tuples are tables", () => {
  const { type, columns, count, least, most } = node("/axles");
  assert.deepEqual([type, columns.map((column) => column.pointer), count, least, most], ["table", ["/x", "/load"], 1, 1, 9]);
  assert.equal(columns[0].unit.symbol, "m");
  assert.deepEqual(node("/profile").columns.map((column) => [column.pointer, column.label]), [["/0", "Column 1"], ["/1", "r"]]);
});

test("a union is a choice by whatever fixed word tells its parts apart", () => {
  const { type, options, chosen, children, tagPointer } = node("/law");
  assert.deepEqual([type, options.map((option) => option.tag), chosen, tagPointer], ["choice", ["linear", "rigid"], "linear", "/law/law"]);
  assert.deepEqual(children.map((child) => child.pointer), ["/law/stiffness"]);
  assert.deepEqual(options[0].initial, { law: "linear", stiffness: 5 });
  assert.equal(tagKey(document.components.schemas.Axle), "");
});

test("what may be left out can be left out", () => {
  assert.deepEqual(node("/stop").options.map((option) => [option.tag, option.initial]), [["", null], ["rigid", { law: "rigid" }]]);
  assert.equal(node("/limit").field.optional, true);
});

test("a list of several kinds has each in its place", () => {
  const { type, children } = node("/parts");
  assert.equal(type, "items");
  assert.deepEqual(children.map((child) => [child.pointer, child.chosen]), [["/parts/0", "rigid"], ["/parts/1", "linear"]]);
  assert.equal(node("/names").field.kind, "texts");
});

test("what a study leaves out is filled in, in the schema's order, and nothing is thrown away", () => {
  const filled = completed(study, { parts: [], law: { law: "linear" }, unknown: 1 }, document);
  assert.deepEqual(Object.keys(filled), ["axles", "profile", "law", "stop", "parts", "limit", "names", "unknown"]);
  assert.deepEqual(filled.law, { law: "linear", stiffness: 5 });
});

test("basic and folded inputs together are all of them, each once", () => {
  const { basic, advanced } = folded(plan.children);
  const found = [...basic, ...advanced].flatMap(pointersOf);
  assert.deepEqual(found.filter((pointer, index) => found.indexOf(pointer) !== index), []);
  for (const pointer of pointersOf(plan)) assert.ok(found.includes(pointer), pointer);
});

test("a field of the solver that nobody placed has a section of its own", () => {
  const keys = ["schema_version", "name", "viaduct", "mesh_level", "train", "wind_load", "modes"];
  const shown = sectionsOf(keys, "crossing").map(({ title }) => title);
  assert.deepEqual(shown, ["Viaduct", "Train", "Wind load"]);
  assert.equal(sectionsOf(keys, "modes")[0].title, "Modes");
});

test("what a modal analysis does not read comes last, and the mesh stands beside the modes", () => {
  const keys = ["viaduct", "mesh_level", "train", "track", "contact", "sweep", "wind_load", "modes"];
  const shown = (part) => sectionsOf(keys, "modes", part).map(({ name, parts, read }) => [name, parts.join(" "), read]);
  assert.deepEqual(shown("train").filter(([, , read]) => read).map(([name]) => name), ["modes", "train", "contact", "wind_load"]);
  assert.deepEqual(shown("viaduct").filter(([, , read]) => read), [["modes", "/modes /mesh_level", true], ["viaduct", "/viaduct", true], ["track", "/track", true], ["wind_load", "/wind_load", true]]);
  assert.deepEqual(shown("track").find(([name]) => name === "viaduct"), ["viaduct", "/viaduct", false]);
  for (const part of ["viaduct", "track", "train"]) {
    assert.deepEqual(shown(part).flatMap(([, parts]) => parts.split(" ")).toSorted(), keys.map((key) => `/${key}`).toSorted(), "each input once");
  }
  assert.ok(sectionsOf(keys, "crossing").every(({ read }) => read));
});

test("names read as engineers write them", () => {
  assert.equal(words("linear_hertz"), "Linear Hertz");
  assert.equal(words("rail_young_modulus"), "Rail Young’s modulus");
  assert.equal(words("sleeper_poisson_ratio"), "Sleeper Poisson’s ratio");
});
