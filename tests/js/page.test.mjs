// Addresses, chart colours and the words of a job that is not done.
import assert from "node:assert/strict";
import { test } from "node:test";
import { channelUrl, compareFigureUrl, eventsUrl, runFigureUrl } from "../../static/js/api.js";
import { themed } from "../../static/js/chart-theme.js";
import { subject, worst } from "../../static/js/job-words.js";
import { link, parse } from "../../static/js/router.js";
import { troubleWords } from "../../static/js/trouble.js";

test("an address names page, parts and query, and survives odd names", () => {
  const route = parse("#/jobs/a%2Fb?t=1.5");
  assert.deepEqual([route.name, route.parts, route.query.get("t")], ["jobs", ["a/b"], "1.5"]);
  assert.equal(parse("").name, "home");
  assert.equal(parse("#/jobs/%E0%A4%A").parts[0], "%E0%A4%A");
  assert.equal(link("jobs", "a/b"), "#/jobs/a%2Fb");
});

test("addresses of files carry window and channels", () => {
  assert.equal(runFigureUrl("r", "displacement", "svg", { from: 1, to: 2, channels: ["a b", "c/d"] }), "/api/v1/runs/r/plots/displacement.svg?from=1&to=2&channels=a+b&channels=c%2Fd");
  assert.equal(compareFigureUrl(["a", "b"], "histories", "csv", { channels: ["c/d"] }), "/api/v1/compare/plots/histories.csv?run=a&run=b&channel=c%2Fd");
  assert.equal(runFigureUrl("r", "point-acceleration", "json", { place: "1,2,3", variant: "" }), "/api/v1/runs/r/plots/point-acceleration.json?place=1%2C2%2C3");
  assert.equal(channelUrl("r", "wheel 01 left/contact force"), "/api/v1/runs/r/channels/wheel%2001%20left%2Fcontact%20force.csv");
  assert.equal(eventsUrl(["x"]), "/api/v1/events?job=x");
  assert.equal(eventsUrl([]), "/api/v1/events");
});

const figure = {
  data: [{ line: { color: "#0072B2" }, x: [1, 2], y: [3, 4] }],
  layout: { title: { text: "T" }, xaxis: { range: [0, 1] }, yaxis: {}, shapes: [{ fillcolor: "#009E73" }], annotations: [{ bgcolor: "#FFFFFF", text: "peak" }] },
  table: [],
  summary: "",
};
const theme = { dark: true, ink: "i", soft: "s", line: "l", paper: "p", type: "t" };

test("dark charts get light curves; the server's figure stays as it is", () => {
  const drawn = themed(figure, theme, false);
  assert.notEqual(drawn.data[0].line.color, "#0072B2");
  assert.equal(figure.data[0].line.color, "#0072B2");
  assert.equal(drawn.data[0].x, figure.data[0].x);
  assert.equal(drawn.layout.annotations[0].bgcolor, "p");
  assert.equal(themed(figure, { ...theme, dark: false }, true).data[0].line.color, "#0072B2");
});

test("a narrow chart keeps a callout's value and a curve's short name", () => {
  const note = { showarrow: true, bgcolor: "#FFFFFF", text: "9.40 m/s²<br>deciding point<br>t = 3.484 s", ax: 48 };
  const curve = { name: "deciding point, x = 29.2 m, y = 0.00 m, below 30 Hz", line: {}, x: [0], y: [0] };
  const crowded = { ...figure, data: [curve], layout: { ...figure.layout, annotations: [note] } };
  const narrow = themed(crowded, theme, true);
  assert.equal(narrow.layout.annotations[0].text, "9.40 m/s²");
  assert.equal(narrow.data[0].name, "deciding point, below 30 Hz");
  const wide = themed(crowded, theme, false);
  assert.equal(wide.layout.annotations[0].text, note.text);
  assert.equal(wide.data[0].name, curve.name);
});

test("a job says what it computes", () => {
  const runs = (...speeds) => speeds.map((speed) => ({ parameters: { speed } }));
  assert.equal(subject({ kind: "crossing", runs: runs(120) }), "432 km/h");
  assert.equal(subject({ kind: "crossing", runs: runs(120, 60, 100) }), "3 speeds, 216 to 432 km/h");
  assert.equal(subject({ kind: "modes", runs: [{ parameters: {} }] }), "Natural modes");
});

test("the run furthest beyond its limit is shown first", () => {
  const judged = (run, value, limit) => ({ run, verdict: { value, limit } });
  assert.equal(worst([judged("a", 3, 3.5), judged("b", 9.4, 3.5), judged("c", 9.5, 5)]).run, "b");
});

test("a failed job says what happened and what to do", () => {
  const words = troubleWords({ state: "failed", error: { detail: "No contact at t = 1 s.", remedy: "Shorten the step." } });
  assert.deepEqual([words.text, words.remedy], ["No contact at t = 1 s.", "Shorten the step."]);
  assert.match(troubleWords({ state: "cancelled", error: null }).heading, /cancelled/);
  assert.match(troubleWords({ state: "out_of_memory", error: "killed" }).remedy, /coarse/);
  assert.equal(troubleWords({ state: "done", error: null }), null);
});
