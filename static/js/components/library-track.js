// @ts-check
/** A ballasted track from the side: rail, pads, sleepers, ballast, with their main figures. */
import { h, s, show } from "../dom.js";
import { quantity } from "../format.js";
import { RAIL_HEIGHT } from "../layout.js";

const SLEEPERS = 5;
/** Depth of the ground under the ballast, for drawing. [m] */
const GROUND = 0.16;
const STIFFNESS = { symbol: "N/m", display: "MN/m", scale: 1e-6 };
const DAMPING = { symbol: "N s/m", display: "kN s/m", scale: 1e-3 };

export class LibraryTrack extends HTMLElement {
  /** @param {any} track */
  set track(track) {
    if (track?.type !== "ballasted") {
      show(this, h("p", { class: "soft" }, "No track: the wheels roll on the beam itself."));
      return;
    }
    const { sleeper_spacing: bay, sleeper_height: height, ballast_depth: depth } = track;
    if (![bay, height, depth].every((size) => size > 0)) {
      show(this, h("p", { class: "soft" }, "This track cannot be drawn: its sleepers and ballast need sizes."));
      return;
    }
    const end = (SLEEPERS - 1) * bay;
    const left = -bay * 0.7;
    const width = end + bay * 1.4 + 0.75;
    const top = -RAIL_HEIGHT - height - 0.42;
    show(
      this,
      s(
        "svg",
        { viewBox: `${left} ${top} ${width} ${depth + GROUND + 0.3 - top}`, class: "elevation track-drawing", role: "img", "aria-label": words(track) },
        s("rect", { class: "soil", x: left, y: depth, width: end + bay * 1.4, height: GROUND }),
        s("path", { class: "ballast", d: `M${left} 0H${end + bay * 0.7}V${depth}H${left}Z` }),
        Array.from({ length: SLEEPERS }, (_, index) => sleeper(index * bay, track)),
        rail(left, end + bay * 0.7, -height - 0.035),
        dimensions(track, end),
      ),
      h("p", { class: "soft small" }, words(track)),
    );
  }
}

/** @param {any} track */
function words(track) {
  const soft = track.transition ? ` falling to ${quantity(track.transition_stiffness, STIFFNESS)} over ${track.transition_length} m before and after the viaduct` : "";
  return (
    `Sleepers every ${track.sleeper_spacing} m on ${track.ballast_depth} m of ballast ${track.ballast_width} m wide; ` +
    `pads of ${quantity(track.pad_stiffness, STIFFNESS)} and ${quantity(track.pad_damping, DAMPING)}${soft}.`
  );
}

/**
 * @param {number} x
 * @param {any} track
 */
function sleeper(x, track) {
  const [base, topWidth, height] = [track.sleeper_width / 2, track.sleeper_top_width / 2, track.sleeper_height];
  return [
    s("path", { class: "sleeper", d: `M${x - base} 0H${x + base}L${x + topWidth} ${-height}H${x - topWidth}Z` }),
    s("rect", { class: "pad", x: x - topWidth * 0.9, y: -height - 0.035, width: topWidth * 1.8, height: 0.035 }),
  ];
}

/**
 * @param {number} from
 * @param {number} to
 * @param {number} foot level of the rail's foot
 */
function rail(from, to, foot) {
  /** @param {string} part @param {number} top @param {number} height above the foot [m] */
  const band = (part, top, height) => s("rect", { class: part, x: from, width: to - from, y: foot - top, height });
  return [band("rail-web", 0.121, 0.0895), band("rail-side", 0.0315, 0.0315), band("rail-side", RAIL_HEIGHT, 0.051)];
}

/**
 * @param {any} track
 * @param {number} end
 */
function dimensions(track, end) {
  const { sleeper_spacing: bay, ballast_depth: depth, sleeper_height: height } = track;
  const level = -height - RAIL_HEIGHT - 0.16;
  const x = end + bay * 0.7 + 0.12;
  return s(
    "g",
    { class: "dimension" },
    s("path", { d: `M${bay} ${level}H${2 * bay}M${bay} ${level - 0.05}v0.1M${2 * bay} ${level - 0.05}v0.1M${x} 0V${depth}M${x - 0.05} 0h0.1M${x - 0.05} ${depth}h0.1M${x} 0V${-height}M${x - 0.05} ${-height}h0.1` }),
    s("text", { x: bay * 1.5, y: level - 0.06, "text-anchor": "middle" }, `${bay} m`),
    s("text", { x: x + 0.1, y: depth / 2 + 0.03 }, `${depth} m`),
    s("text", { x: x + 0.1, y: -height / 2 + 0.03 }, `${height} m`),
  );
}

customElements.define("tb-library-track", LibraryTrack);
