// @ts-check
/** The verdict: the server's statement as it stands, value beside limit, scope, what to know. */
import { h, s, show } from "../dom.js";
import { besideLimit, number, speed, unitText } from "../format.js";

/** @typedef {import("../types.js").Verdict} Verdict */

export class VerdictBar extends HTMLElement {
  /**
   * @param {Verdict} verdict
   * @param {string[]} accuracy what was measured of the mesh's accuracy, in sentences
   */
  bind(verdict, accuracy) {
    const notes = withAccuracy(verdict.notes, accuracy);
    const side = verdict.exceeds ? "exceeds" : "within";
    this.className = `card verdict ${side}`;
    show(
      this,
      h(
        "div",
        { class: "verdict-head" },
        mark(verdict.exceeds),
        h(
          "div",
          { class: "verdict-words" },
          h("h2", null, heading(verdict)),
          h("p", { class: "statement" }, sentence(verdict.statement)),
        ),
        gauge(verdict),
      ),
      notes.length > 0 && h("ul", { class: "verdict-notes" }, notes.map((note) => h("li", null, note))),
      details(verdict),
    );
  }
}

/**
 * The accuracy stands with the note that it explains.
 *
 * @param {string[]} notes
 * @param {string[]} accuracy
 */
function withAccuracy(notes, accuracy) {
  const screening = notes.findIndex((note) => /screening mesh/i.test(note));
  if (screening < 0) return [...notes, ...accuracy];
  return notes.with(screening, [notes[screening], ...accuracy].join(" "));
}

/** @param {Verdict} verdict */
function heading(verdict) {
  const screening = verdict.scope.mesh_level === "coarse" ? " (screening mesh)" : "";
  const at = speed(verdict.scope.speed);
  return `${verdict.exceeds ? "Exceeds the limit" : "Within the limit"} at ${at}${screening}`;
}

/** @param {string} text */
const sentence = (text) => text.charAt(0).toUpperCase() + unbroken(text.slice(1)) + ".";

/** A quantity never breaks from its sign or unit. @param {string} text */
const unbroken = (text) =>
  text.replace(/ = /g, "\u00a0=\u00a0").replace(/ (m\/s)2/g, "\u00a0$1²").replace(/ (km\/h|Hz|m|s)(?=[,:;) ]|$)/g, "\u00a0$1");

/** The sign does not speak by colour alone. @param {boolean} exceeds */
function mark(exceeds) {
  const d = exceeds ? "M12 3 L22 20 H2 Z M12 9.5 V14 M12 16.6 V17" : "M4 12.5 L10 18 L20 6.5";
  return s("svg", { viewBox: "0 0 24 24", width: 34, height: 34, class: "mark", "aria-hidden": "true" }, s("path", { d }));
}

/** @param {Verdict} verdict */
function gauge(verdict) {
  const unit = unitText(verdict.unit);
  const top = Math.max(verdict.value, verdict.limit) * 1.18;
  const width = 200;
  const x = (/** @type {number} */ value) => ((value / top) * width).toFixed(1);
  return h(
    "div",
    { class: "gauge" },
    h("p", { class: "figure" }, besideLimit(verdict.value, verdict.limit), h("span", null, ` ${unit}`)),
    s(
      "svg",
      { viewBox: `0 0 ${width} 22`, "aria-hidden": "true" },
      s("rect", { class: "track", x: 0, y: 3, width, height: 8, rx: 4 }),
      s("rect", { class: "bar", x: 0, y: 3, width: x(verdict.value), height: 8, rx: 4 }),
      s("line", { class: "limit", x1: x(verdict.limit), x2: x(verdict.limit), y1: 0, y2: 16 }),
    ),
    h("p", { class: "small soft" }, `limit ${number(verdict.limit, 3)} ${unit}, raw ${number(verdict.raw.value, 3)} ${unit}`),
  );
}

/** @param {Verdict} verdict */
function details(verdict) {
  const unit = unitText(verdict.unit);
  const rows = [
    ...verdict.spans.map((span) => ({
      name: `Span ${span.number}, greatest`,
      ...span,
      remark: span.judged ? "decides" : span.remark,
    })),
    ...verdict.points.map((point) => ({ ...point, remark: "" })),
  ];
  return h(
    "details",
    null,
    h("summary", null, "Basis, other points and spans"),
    h(
      "dl",
      { class: "basis" },
      pair("Clause", verdict.clause),
      pair("Filter", verdict.filter),
      pair("Cut-off", `${number(verdict.cut_off, 3)} Hz: ${verdict.cut_off_origin}`),
      pair("Holds for", scope(verdict)),
    ),
    rows.length > 0 &&
      h(
        "div",
        { class: "scroll", tabindex: 0, role: "region", "aria-label": "Peaks of points and spans" },
        h(
          "table",
          null,
          h("thead", null, h("tr", null, ["Where", `filtered [${unit}]`, "at x, y [m]", "t [s]", `raw [${unit}]`, ""].map((text) => h("th", { scope: "col" }, text)))),
          h("tbody", null, rows.map((item) => row(item, verdict.limit))),
        ),
      ),
  );
}

/**
 * @param {{ name: string, filtered: import("../types.js").Peak, raw: import("../types.js").Peak, remark: string }} item
 * @param {number} limit
 */
function row(item, limit) {
  const place = item.filtered.place;
  return h(
    "tr",
    null,
    h("th", { scope: "row" }, item.name.charAt(0).toUpperCase() + item.name.slice(1)),
    h("td", null, besideLimit(item.filtered.value, limit)),
    h("td", null, `${place.x.toFixed(1)}, ${place.y.toFixed(2)}`.replaceAll("-", "−")),
    h("td", null, item.filtered.time.toFixed(3)),
    h("td", null, item.raw.value.toFixed(2)),
    h("td", { class: "soft" }, item.remark),
  );
}

/** @param {Verdict} verdict */
function scope(verdict) {
  const { train, mesh_level: mesh, irregularity } = verdict.scope;
  return [train, speed(verdict.scope.speed), irregularity, mesh && `${mesh} mesh`].filter(Boolean).join(", ");
}

/**
 * @param {string} term
 * @param {string} text
 */
const pair = (term, text) => h("div", null, h("dt", null, term), h("dd", null, text));

customElements.define("tb-verdict-bar", VerdictBar);
