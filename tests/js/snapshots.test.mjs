// What pytest recorded of the API is what the page's pure modules read: a change of the API fails both.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { runFigureUrl } from "../../static/js/api.js";
import { logLines, subject } from "../../static/js/job-words.js";
import { tabsOf } from "../../static/js/job-tabs.js";
import { momentOfInterest } from "../../static/js/moment.js";
import { link, pageKey, parse } from "../../static/js/router.js";
import { pageName } from "../../static/js/pages.js";
import { asChoice, resolved } from "../../static/js/theme.js";
import { troubleWords } from "../../static/js/trouble.js";

const FOLDER = new URL("snapshots/", import.meta.url);
/** @param {string} name */
const answer = (name) => JSON.parse(readFileSync(new URL(`${name}.json`, FOLDER), "utf8")).answer;
const names = readdirSync(FOLDER).map((file) => file.replace(".json", ""));

test("a job of every state is recorded, and each has its words or needs none", () => {
  const said = Object.fromEntries(
    ["queued", "running", "done", "failed", "cancelled", "timed_out", "out_of_memory"].map((state) => {
      const job = answer(`job-${state}`);
      assert.equal(job.state, state);
      return [state, troubleWords(job)];
    }),
  );
  assert.deepEqual([said.queued, said.running, said.done], [null, null, null]);
  assert.match(said.failed.text, /did not settle at t = 1.25 s/);
  assert.match(said.out_of_memory.text, /took 300 MB, the limit is 250 MB/);
  assert.match(said.timed_out.text, /0\.3 s/);
  assert.match(said.cancelled.stable, /up to t = 0\.225 s, step 900 of 3.600/);
  for (const state of ["failed", "cancelled", "timed_out", "out_of_memory"]) assert.ok(said[state].heading && said[state].remedy);
});

test("what a job computes is read from its runs", () => {
  assert.equal(subject(answer("job-done")), "100 km/h");
  assert.equal(subject(answer("job-sweep")), "3 speeds, 72 to 108 km/h");
  assert.equal(subject(answer("job-modes")), "Natural modes");
});

test("tabs hold the figures that the server lists", () => {
  const tabs = tabsOf(answer("job-done"), answer("run-figures").items);
  const figures = Object.fromEntries(tabs.map((tab) => [tab.id, tab.figures.map((figure) => figure.name)]));
  assert.deepEqual(figures.overview, ["slab-acceleration", "contact-force", "displacement"]);
  assert.deepEqual(figures.vehicle, ["vehicle-acceleration"]);
  assert.ok(tabsOf(answer("job-sweep"), []).some((tab) => tab.id === "sweep"));
  assert.equal(tabsOf(answer("job-modes"), [])[0].title, "Modes");
});

test("every figure brings curves, words and a table", () => {
  for (const name of names.filter((item) => item.startsWith("figure-"))) {
    const figure = answer(name);
    assert.ok(figure.data.length > 0, name);
    assert.ok(figure.summary.length > 20, name);
    assert.ok(Array.isArray(figure.table), name);
    assert.ok(figure.layout.xaxis && figure.layout.yaxis && Array.isArray(figure.layout.annotations), name);
    for (const curve of figure.data.filter((item) => item.type === "scatter" && item.x)) assert.equal(curve.x.length, curve.y.length, name);
  }
});

test("curves are told apart without their colour", () => {
  for (const name of names.filter((item) => item.startsWith("figure-") || item.startsWith("compare-"))) {
    const lines = answer(name).data.filter((curve) => curve.mode === "lines" && curve.showlegend !== false && curve.line?.width !== 0);
    const looks = lines.map((curve) => `${curve.line?.dash ?? "solid"} ${curve.line?.width ?? ""} ${curve.marker?.symbol ?? ""}`);
    const tones = lines.map((curve) => curve.line?.color);
    if (new Set(tones).size > 1) assert.equal(new Set(looks).size, looks.length, `${name}: ${looks}`);
  }
});

test("the moment of interest of a finished run lies within it", () => {
  const moment = momentOfInterest(answer("run-done"));
  assert.ok(moment > 0 && moment <= 0.9);
});

test("templates name what they compute and hold a study", () => {
  const { items } = answer("templates");
  assert.ok(items.length >= 8);
  for (const item of items) {
    assert.ok(["crossing", "modes"].includes(item.kind), item.name);
    assert.ok(item.title && item.description && item.study.schema_version, item.name);
    assert.equal(pageName(parse(link("study", item.name))), "study");
  }
});

test("addresses of pages: those that are, those that are not, and which show the same page", () => {
  const page = (/** @type {string} */ hash) => pageName(parse(hash));
  assert.deepEqual(
    ["", "#/", "#/jobs", "#/jobs/a", "#/study/x", "#/study?job=a", "#/compare?runs=a,b", "#/library", "#/library/trains/khst", "#/report/a"].map(page),
    ["home", "home", "jobs", "job", "study", "study", "compare", "library", "library", "report"],
  );
  assert.deepEqual(["#/study", "#/jobs/a/b", "#/report", "#/none", "#/library/a/b/c", "#/__proto__"].map(page), Array(6).fill(null));
  const key = (/** @type {string} */ hash) => pageKey(parse(hash));
  assert.equal(key("#/jobs/a?t=1&tab=log"), key("#/jobs/a?t=2"));
  assert.notEqual(key("#/study?job=a"), key("#/study?job=b"));
  assert.notEqual(key("#/jobs/a"), key("#/jobs/b"));
});

test("the theme follows the choice, else the system", () => {
  assert.deepEqual([resolved("system", true), resolved("system", false), resolved("light", true), resolved("dark", false)], ["dark", "light", "light", "dark"]);
  assert.deepEqual([asChoice("dark"), asChoice("blue"), asChoice(null)], ["dark", "system", "system"]);
});

test("a figure's address has the run's name as it is", () => {
  assert.equal(runFigureUrl("run-done", "displacement", "json", { points: 80 }), "/api/v1/runs/run-done/plots/displacement.json?points=80");
  assert.deepEqual(logLines("2026-01-01T12:00:00Z  run 0 (r)  began\n"), [{ time: "2026-01-01T12:00:00Z", run: "run 1", words: "began" }]);
});
