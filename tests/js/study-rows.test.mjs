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
