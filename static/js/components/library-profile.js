// @ts-check
/** The profiles r(x) of an irregularity with axes; the height is drawn larger than the length. */
import { h, s, show } from "../dom.js";
import { number } from "../format.js";
import { profileOf } from "../irregularity-profile.js";

const [WIDTH, HEIGHT] = [720, 276];
/** What an axis spans where the profile has no height. [m] */
const FLAT = 1e-3;
const PLOT = { left: 76, right: 16, top: 32, bottom: 62 };

export class LibraryProfile extends HTMLElement {
  /** @param {any} irregularity */
  set irregularity(irregularity) {
    const profile = profileOf(irregularity);
    if (!profile) {
      show(this, h("p", { class: "soft" }, irregularity?.type === "none" ? "Perfect rails: r(x) = 0 everywhere." : "Nothing to draw yet."));
      return;
    }
    const { x, lines, words } = profile;
    const heights = lines.flatMap(({ r }) => r);
    const low = Math.min(0, ...heights) * 1.15;
    const high = Math.max(0, ...heights) * 1.15 || (low ? 0 : FLAT);
    const across = scale(x[0], x[x.length - 1], PLOT.left, WIDTH - PLOT.right);
    const up = scale(low, high, HEIGHT - PLOT.bottom, PLOT.top);
    const paths = lines.map(({ r }) => x.map((place, index) => `${across(place).toFixed(2)} ${up(r[index]).toFixed(2)}`).join("L"));
    show(
      this,
      s(
        "svg",
        { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "profile", role: "img", "aria-label": `Profile of the rail: ${words}` },
        ticks(low * 1000, high * 1000).map((value) => level(value, up(value / 1000))),
        ticks(x[0], x[x.length - 1]).map((value) => column(value, across(value))),
        s("text", { class: "axis", x: (PLOT.left + WIDTH - PLOT.right) / 2, y: HEIGHT - 7, "text-anchor": "middle" }, "x [m], the first span begins at 0"),
        s("text", { class: "axis", transform: `translate(22 ${(HEIGHT - PLOT.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, "r [mm]"),
        paths.length === 1 && s("path", { class: "profile-area", d: `M${across(x[0])} ${up(0)}L${paths[0]}L${across(x[x.length - 1])} ${up(0)}Z` }),
        paths.map((path, index) => s("path", { class: index ? "profile-line other" : "profile-line", d: `M${path}` })),
        paths.length > 1 && lines.map(({ name }, index) => key(name, index)),
      ),
      h("p", { class: "soft small" }, words, " Upward lifts the wheel; the height is drawn larger than the length."),
    );
  }
}

/** Which line is which rail's. @param {string} name @param {number} index */
function key(name, index) {
  const x = WIDTH - PLOT.right - 330 + index * 165;
  return s(
    "g",
    null,
    s("path", { class: index ? "profile-line other" : "profile-line", d: `M${x} 14h28` }),
    s("text", { class: "axis", x: x + 34, y: 20 }, name),
  );
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} from
 * @param {number} to
 * @returns {(value: number) => number}
 */
const scale = (low, high, from, to) => (value) => from + ((value - low) / (high - low)) * (to - from);

/**
 * A few round values between two.
 *
 * @param {number} low
 * @param {number} high
 */
function ticks(low, high) {
  const rough = (high - low) / 5;
  const order = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((part) => part * order >= rough) ?? 10) * order;
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, index) => (first + index) * step);
}

/**
 * @param {number} value
 * @param {number} y
 */
function level(value, y) {
  return s(
    "g",
    { class: "tick" },
    s("line", { x1: PLOT.left, x2: WIDTH - PLOT.right, y1: y, y2: y }),
    s("text", { x: PLOT.left - 8, y: y + 4, "text-anchor": "end" }, number(value, 4)),
  );
}

/**
 * @param {number} value
 * @param {number} x
 */
function column(value, x) {
  return s(
    "g",
    { class: "tick" },
    s("line", { x1: x, x2: x, y1: PLOT.top, y2: HEIGHT - PLOT.bottom }),
    s("text", { x, y: HEIGHT - PLOT.bottom + 25, "text-anchor": "middle" }, number(value, 4)),
  );
}

customElements.define("tb-library-profile", LibraryProfile);
