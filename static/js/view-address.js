// @ts-check
/**
 * What is looked at, as the query of the page's address, and back: a shared link shows the same
 * picture. Pure.
 */

/** @typedef {{ from: number, to: number } | null} TimeWindow */
/** @typedef {[number, number, number]} Point x, y, z [m] */
/** @typedef {import("./types.js").CameraPose} CameraPose */
/**
 * @typedef {object} Look
 * @property {string} run id; empty for the one that the page proposes
 * @property {string} tab
 * @property {number | null} time [s]
 * @property {TimeWindow} window
 * @property {Point | null} place whose history is shown
 * @property {number} mode of a modal analysis, counted from 1
 * @property {string} colour what the 3D view's colours stand for; empty for the viewer's own choice
 * @property {number | null} scale of the deformation
 * @property {string} camera
 * @property {CameraPose | null} pose of the camera, where somebody moved it away from its preset's place
 * @property {string[]} hidden layers of the 3D view
 * @property {Record<string, string[]>} channels chosen for each figure
 * @property {Record<string, string>} variants how a figure is drawn that has several ways
 */

/**
 * What an address asks for; whatever it spells wrong is left out.
 *
 * @param {URLSearchParams} query
 * @returns {Look}
 */
export function lookOf(query) {
  const number = (/** @type {string} */ key) => finite(query.get(key));
  const [from, to] = [number("from"), number("to")];
  return {
    run: query.get("run") ?? "",
    tab: query.get("tab") ?? "",
    time: number("t"),
    window: from !== null && to !== null && from < to ? { from, to } : null,
    place: pointOf(query.get("place")),
    mode: Math.max(1, Math.round(number("mode") ?? 1)),
    colour: query.get("colour") ?? "",
    scale: number("scale"),
    camera: query.get("camera") ?? "",
    pose: poseOf(query.get("pose")),
    hidden: (query.get("hidden") ?? "").split(",").filter(Boolean),
    channels: channelsOf(query.get("channels") ?? ""),
    variants: variantsOf(query.get("variant") ?? ""),
  };
}

/**
 * The part of an address that says some of it; null takes a key away.
 *
 * @param {Partial<Look>} look
 * @returns {Record<string, string | null>}
 */
export function addressOf(look) {
  /** @type {Record<string, string | null>} */
  const address = {};
  for (const key of /** @type {const} */ (["run", "tab", "colour", "camera"])) {
    if (key in look) address[key] = look[key] || null;
  }
  if ("time" in look) address.t = fixed(look.time);
  if ("window" in look) {
    address.from = fixed(look.window?.from);
    address.to = fixed(look.window?.to);
  }
  if ("place" in look) address.place = look.place ? pointText(look.place) : null;
  if ("pose" in look) address.pose = look.pose ? poseText(look.pose) : null;
  if ("mode" in look) address.mode = look.mode && look.mode > 1 ? String(look.mode) : null;
  if ("scale" in look) address.scale = look.scale ? String(look.scale) : null;
  if ("hidden" in look) address.hidden = look.hidden?.join(",") || null;
  if ("channels" in look) address.channels = channelsText(look.channels ?? {}) || null;
  if ("variants" in look) address.variant = variantsText(look.variants ?? {}) || null;
  return address;
}

/** @param {Point} point */
function pointText(point) {
  return point.map((value) => String(Number(value.toFixed(4)))).join(",");
}

/**
 * @param {string | null} text
 * @returns {Point | null}
 */
function pointOf(text) {
  const parts = (text ?? "").split(",").map(finite);
  return parts.length === 3 && !parts.includes(null) ? /** @type {Point} */ (parts) : null;
}

/** Of coordinates, as the server bounds them. [m] */
const FARTHEST = 1e5;
/** Between the eye and what it looks at. [m] */
const NEAREST = 0.01;

/**
 * The eye, what it looks at, and the field of view where the preset does not say it.
 *
 * @param {CameraPose} pose
 */
export function poseText({ position, look_at, fov }) {
  const numbers = [...position, ...look_at].map((value) => String(Number(value.toFixed(3)) + 0));
  return [...numbers, ...(fov ? [String(Number(fov.toFixed(4)))] : [])].join(",");
}

/**
 * @param {string | null} text
 * @returns {CameraPose | null}
 */
function poseOf(text) {
  const numbers = (text ?? "").split(",").map(finite);
  const [x, y, z, atX, atY, atZ, fov = null] = numbers.map((value) => value ?? Number.NaN);
  if (numbers.includes(null) || numbers.length < 6 || numbers.length > 7) return null;
  const near = [x, y, z, atX, atY, atZ].every((value) => Math.abs(value) <= FARTHEST);
  const looks = Math.hypot(x - atX, y - atY, z - atZ) >= NEAREST;
  const seen = fov === null || (fov >= 0.01 && fov <= 2.6);
  return near && looks && seen ? { position: [x, y, z], look_at: [atX, atY, atZ], fov } : null;
}

/** @param {Record<string, string[]>} channels */
function channelsText(channels) {
  return Object.entries(channels)
    .filter(([, names]) => names.length)
    .map(([figure, names]) => `${figure}:${names.map(guarded).join("|")}`)
    .join(";");
}

/** @param {string} text */
function channelsOf(text) {
  /** @type {Record<string, string[]>} */
  const channels = {};
  for (const part of text.split(";")) {
    const colon = part.indexOf(":");
    if (colon > 0) channels[part.slice(0, colon)] = part.slice(colon + 1).split("|").filter(Boolean).map(unguarded);
  }
  return channels;
}

/** @param {Record<string, string>} variants */
function variantsText(variants) {
  return Object.entries(variants).map(([figure, variant]) => `${figure}:${variant}`).join(";");
}

/** @param {string} text */
function variantsOf(text) {
  const pairs = text.split(";").map((part) => part.split(":"));
  return Object.fromEntries(pairs.filter((pair) => pair.length === 2 && pair[0] && pair[1]));
}

/** @param {string} name */
const guarded = (name) => name.replace(/[%;|]/g, encodeURIComponent);

/** @param {string} name */
const unguarded = (name) => name.replace(/%(25|3B|7C)/gi, decodeURIComponent);

/** @param {string | null} text */
function finite(text) {
  if (text === null || text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : null;
}

/** @param {number | null | undefined} time */
const fixed = (time) => (typeof time === "number" ? time.toFixed(4) : null);
