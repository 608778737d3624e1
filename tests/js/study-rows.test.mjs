// A study as a table to read, beside the template it came from.
import assert from "node:assert/strict";
import { test } from "node:test";
import { closestTemplate, studySections } from "../../static/js/study-rows.js";

const metre = { symbol: "m", display: "mm", scale: 1000 };
const document = {
  components: {
    schemas: {
      Study: {
        properties: {
          schema_version: { type: "integer" },
          name: { type: "string" },
          irregularity: { oneOf: [{ properties: { type: { const: "none" } } }, { properties: { type: { const: "isolated" }, amplitude: { type: "number", unit: metre } } }] },
          line_speed: { type: "number", unit: { symbol: "m/s", display: "km/h", scale: 3.6 } },
          contact: { properties: { unilateral: { type: "boolean" } } },
        },
      },
    },
  },
};
const study = { schema_version: 1, name: "Mine", irregularity: { type: "isolated", amplitude: -0.016 }, contact: { unilateral: true } };

test("inputs have their display unit, and say what the template has instead", () => {
  const template = { ...study, irregularity: { type: "isolated", amplitude: 0.001 } };
  const rows = studySections(study, "crossing", template, document).flatMap((section) => section.groups).flatMap((group) => group.rows);
  const amplitude = rows.find((row) => row.pointer === "/irregularity/amplitude");
  assert.deepEqual([amplitude.text, amplitude.unit, amplitude.standard], ["−16", "mm", "1"]);
  assert.equal(rows.find((row) => row.pointer === "/contact/unilateral").text, "yes");
  assert.equal(rows.find((row) => row.pointer === "/contact/unilateral").standard, null);
});

test("a zero that stands for something says what, as the report does", () => {
  const template = { ...study, line_speed: 50 };
  const row = (/** @type {any} */ own, /** @type {any} */ other) =>
    studySections(own, "crossing", other, document).flatMap((section) => section.groups).flatMap((group) => group.rows).find((found) => found.pointer === "/line_speed");
  const unstated = row({ ...study, line_speed: 0 }, template);
  assert.deepEqual([unstated.text, unstated.unit, unstated.standard, unstated.standardUnit], ["not stated", "", "180", "km/h"]);
  const stated = row(template, { ...study, line_speed: 0 });
  assert.deepEqual([stated.text, stated.unit, stated.standard, stated.standardUnit], ["180", "km/h", "not stated", ""]);
});

test("another kind of irregularity is a difference even where the template lacks the input", () => {
  const template = { ...study, irregularity: { type: "none" } };
  const rows = studySections(study, "crossing", template, document).flatMap((section) => section.groups).flatMap((group) => group.rows);
  assert.equal(rows.find((row) => row.pointer === "/irregularity/amplitude").standard, "–");
});

test("the template is the one of the study's name, else the one most alike", () => {
  const far = { name: "far", kind: "crossing", study: { name: "Far", contact: {}, irregularity: { type: "none" } } };
  const near = { name: "near", kind: "crossing", study: { ...study, name: "Near" } };
  assert.equal(closestTemplate(study, "crossing", [far, near]).name, "near");
  assert.equal(closestTemplate({ ...study, name: "Far" }, "crossing", [far, near]).name, "far");
});
