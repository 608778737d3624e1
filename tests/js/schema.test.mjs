// The form is what the schema says: unions, units, bounds, arrays.
import assert from "node:assert/strict";
import { test } from "node:test";
import { at, nearest, withValue } from "../../static/js/pointer.js";
import { entered, range, shown } from "../../static/js/entry.js";
import { defaults, field, fieldsUnder, schemaAt, variants } from "../../static/js/schema.js";

const speedUnit = { symbol: "m/s", display: "km/h", scale: 3.6 };
const number = { type: "number", unit: speedUnit, exclusiveMinimum: 0, maximum: 200, description: "Speed of the train." };
const document = {
  components: {
    schemas: {
      Study: {
        type: "object",
        properties: {
          schema_version: { const: 1, type: "integer", default: 1 },
          mesh_level: { type: "string", enum: ["coarse", "standard"], default: "standard" },
          irregularity: {
            discriminator: { propertyName: "type" },
            oneOf: [{ $ref: "#/components/schemas/None" }, { $ref: "#/components/schemas/Defect" }],
          },
          sweep: { $ref: "#/components/schemas/Sweep", description: "Speeds." },
          contact: { type: "object", properties: { unilateral: { type: "boolean" } } },
        },
      },
      Sweep: { type: "object", properties: { speeds: { type: "array", items: number } } },
      None: { type: "object", properties: { type: { const: "none", type: "string", default: "none" } } },
      Defect: {
        type: "object",
        properties: {
          type: { const: "isolated", type: "string", default: "isolated" },
          amplitude: { type: "number", default: 0.01, minimum: -0.05, maximum: 0.05, unit: { symbol: "m", display: "mm", scale: 1000 } },
          rail: { enum: ["left", "right"], type: "string", default: "right" },
        },
      },
    },
  },
};
const schema = document.components.schemas.Study;
const study = { schema_version: 1, mesh_level: "coarse", irregularity: { type: "isolated", amplitude: 0.016, rail: "right" }, sweep: { speeds: [120, 130] }, contact: { unilateral: true } };

test("every plain input becomes one field, the chosen alternative's only", () => {
  const pointers = fieldsUnder(schema, study, "", document).map((item) => item.pointer);
  assert.deepEqual(pointers, ["/mesh_level", "/irregularity/amplitude", "/irregularity/rail", "/sweep/speeds", "/contact/unilateral"]);
  const none = fieldsUnder(schema, { ...study, irregularity: { type: "none" } }, "", document);
  assert.ok(!none.some((item) => item.pointer.startsWith("/irregularity")));
});

test("alternatives have tags, and defaults to begin with", () => {
  const found = variants(schemaAt(schema, study, "/irregularity", document), document);
  assert.deepEqual(found.map((item) => item.tag), ["none", "isolated"]);
  assert.deepEqual(defaults(found[1].schema, document), { type: "isolated", amplitude: 0.01, rail: "right" });
});

test("a field shows display units and stores SI", () => {
  const speed = field(schemaAt(schema, study, "/sweep/speeds/0", document), 120, "/sweep/speeds/0", document);
  assert.equal(speed.label, "Speed 1");
  assert.equal(shown(120, speed), "432");
  assert.equal(shown(100 / 3.6, speed), "100");
  assert.deepEqual(entered("432", speed), { value: 120 });
  assert.deepEqual(entered("350,5", speed), { value: 97.3611111111 });
  assert.match(entered("0", speed).error, /greater than 0 km\/h/);
  assert.match(entered("721", speed).error, /at most 720 km\/h/);
  assert.match(entered("fast", speed).error, /number/);
  assert.match(entered("", speed).error, /number/);
  assert.match(entered("1e999", speed).error, /number/);
  assert.equal(range(speed), "more than 0, up to 720 km/h");
  assert.equal(range({ ...speed, above: false }), "0 to 720 km/h");
  assert.equal(range({ ...speed, maximum: null }), "more than 0 km/h");
});

test("numbers in a row are one field: a sweep of speeds", () => {
  const speeds = field(schemaAt(schema, study, "/sweep/speeds", document), [120], "/sweep/speeds", document);
  assert.equal(speeds.kind, "list");
  assert.equal(speeds.unit.display, "km/h");
  assert.equal(shown([120, 200 / 3.6], speeds), "432, 200");
  assert.deepEqual(entered("216, 360;432", speeds), { value: [60, 100, 120] });
  assert.deepEqual(entered("432", speeds), { value: [120] });
  assert.match(entered("200, 0, 432", speeds).error, /^0: Must be greater than 0 km\/h/);
  assert.match(entered("200, fast", speeds).error, /^fast: Give a number/);
  assert.match(entered(" , ", speeds).error, /Give a number/);
  assert.match(entered("1 2 3", { ...speeds, most: 2 }).error, /at most 2/);
});

test("pointers read and change without touching what was", () => {
  const changed = withValue(study, "/sweep/speeds/1", 99);
  assert.equal(at(changed, "/sweep/speeds/1"), 99);
  assert.equal(at(study, "/sweep/speeds/1"), 130);
  assert.equal(changed.irregularity, study.irregularity);
  assert.ok(Array.isArray(changed.sweep.speeds));
  assert.equal(at({ "a/b": { "~": 1 } }, "/a~1b/~0"), 1);
  assert.equal(at(null, "/a"), undefined);
});

test("a finding goes to its field, or to the nearest one", () => {
  const fields = ["/sweep/speeds/0", "/mesh_level", "/irregularity/amplitude"];
  assert.equal(nearest("/study/sweep/speeds/0", fields), "/sweep/speeds/0");
  assert.equal(nearest("/sweep/speeds", fields), "/sweep/speeds/0");
  assert.equal(nearest("/sweep/speeds/3", ["/sweep/speeds"]), "/sweep/speeds");
  assert.equal(nearest("/mesh_level/coarse", fields), "/mesh_level");
  assert.equal(nearest("/viaduct/spans", fields), null);
  assert.equal(nearest("", fields), null);
});
