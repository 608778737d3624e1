// The study as text: JSON with the lines of its errors, and commands that run it elsewhere.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import { exportsOf, literal } from "../../static/js/code-export.js";
import { lineOf, read } from "../../static/js/json-source.js";

const TEXT = `{
  "name": "a \\"quoted\\" name",
  "sweep": {
    "speeds": [120,
      130]
  },
  "a/b": null
}`;

test("the reader gives what JSON.parse gives, and the line of every value", () => {
  const { value, lines, error } = read(TEXT);
  assert.equal(error, null);
  assert.deepEqual(value, JSON.parse(TEXT));
  assert.deepEqual(["", "/name", "/sweep", "/sweep/speeds", "/sweep/speeds/1", "/a~1b"].map((pointer) => lines.get(pointer)), [1, 2, 3, 4, 5, 7]);
  assert.equal(lineOf(lines, "/study/sweep/speeds/1"), 5);
  assert.equal(lineOf(lines, "/sweep/unknown"), 3, "the place around it");
  assert.equal(lineOf(lines, "/nowhere"), 1);
  assert.equal(lineOf(read('{\n"study": {\n"name": 1}}').lines, "/study/name"), 3);
});

test("what is broken is said with its line and column", () => {
  const at = (text) => read(text).error;
  assert.deepEqual(at('{\n  "a": 1\n  "b": 2\n}'), { line: 3, column: 3, message: "Expected a comma or }" });
  assert.match(at('{"a": tru}').message, /tru is no number/);
  assert.match(at('{"a": NaN}').message, /NaN is no number/);
  assert.match(at('{"a": 01}').message, /01 is no number/);
  assert.match(at('{"a": [1, 2').message, /ends too early/);
  assert.match(at("").message, /ends too early/);
  assert.match(at('{"a": "x\n"}').message, /no closing quote/);
  assert.match(at('{"a": 1, "a": 2}').message, /"a" stands here twice/);
  assert.match(at('{"a": 1}}').message, /Nothing may follow/);
  assert.match(at("[".repeat(200)).message, /too deeply/);
  assert.match(at("{a: 1}").message, /name in quotes/);
  assert.equal(Object.getPrototypeOf(read('{"__proto__": {"x": 1}}').value), Object.prototype);
});

test("Python reads the literal as JSON reads the text", () => {
  assert.equal(literal({ a: [1, 2.5e-7], b: true, c: null, d: {} }, ""), '{\n    "a": [1, 2.5e-7],\n    "b": True,\n    "c": None,\n    "d": {},\n}');
});

test("no name of a study ends a shell's text early or becomes a command", () => {
  const study = { name: "x'; rm -rf $HOME\nSTUDY\n`id` \u2028 é" };
  for (const way of exportsOf("crossing").filter((item) => item.name !== "python")) {
    const text = way.text({ study, kind: "crossing", origin: "http://127.0.0.1:8000" });
    const echoed = execFileSync("sh", ["-c", `curl() { cat; }; trainbridge() { cat; }\n${text}`], { encoding: "utf8", env: { PATH: process.env.PATH } });
    const sent = JSON.parse(echoed);
    assert.equal((sent.study ?? sent).name, study.name, way.name);
  }
});

test("modes have no way without a server: `trainbridge run` computes crossings", () => {
  assert.deepEqual(exportsOf("modes").map((item) => item.name), ["curl", "submit", "python"]);
});
