// @ts-check
/** Numbers, times and sizes in the words of an engineer. Pure. */

/** @typedef {import("./types.js").Unit} Unit */

const PRETTY = new Map([
  ["m/s2", "m/s²"],
  ["m2", "m²"],
  ["m3", "m³"],
  ["m4", "m⁴"],
  ["kg/m3", "kg/m³"],
  ["kg m2", "kg·m²"],
  ["N s/m", "N·s/m"],
  ["kN s/m", "kN·s/m"],
  ["MN/m^1.5", "MN/m¹·⁵"],
  ["1", ""],
]);

/**
 * A unit's symbol as it is printed.
 *
 * @param {Unit | string | null | undefined} unit
 */
export function unitText(unit) {
  if (!unit) return "";
  const symbol = typeof unit === "string" ? unit : unit.display || unit.symbol;
  return PRETTY.get(symbol) ?? symbol;
}

/**
 * A number with a few significant figures and thin spaces between thousands.
 *
 * @param {number | null | undefined} value
 * @param {number} [figures]
 */
export function number(value, figures = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return minus(value.toExponential(Math.max(figures - 1, 0)));
  const decimals = Math.max(0, figures - 1 - Math.floor(Math.log10(size)));
  const [whole, part] = value.toFixed(Math.min(decimals, 12)).split(".");
  const grouped = whole.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
  const rest = (part ?? "").replace(/0+$/, "");
  return minus(rest ? `${grouped}.${rest}` : grouped);
}

/** @param {string} text */
const minus = (text) => text.replace("-", "−");

/**
 * A stored SI value with its display unit.
 *
 * @param {number} value
 * @param {Unit | string | null | undefined} unit
 * @param {number} [figures]
 */
export function quantity(value, unit, figures = 3) {
  const scale = unit && typeof unit === "object" ? unit.scale : 1;
  return `${number(value * scale, figures)} ${unitText(unit)}`.trim();
}

/**
 * A speed in km/h.
 *
 * @param {number} speed [m/s]
 */
export function speed(speed) {
  return `${number(Math.round(speed * 36) / 10, 4)} km/h`;
}

/**
 * A duration that people can plan with: "8 s", "2 min 5 s", "1 h 10 min".
 *
 * @param {number | null | undefined} seconds
 */
export function duration(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return "–";
  if (seconds < 1) return "under 1 s";
  const whole = Math.round(seconds);
  if (whole < 90) return `${whole} s`;
  if (whole < 600 && whole % 60) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  const minutes = Math.round(whole / 60);
  if (minutes < 90) return `${minutes} min`;
  const rest = minutes % 60;
  return rest ? `${Math.floor(minutes / 60)} h ${rest} min` : `${minutes / 60} h`;
}

/**
 * What is left of a computation, as a range, for nobody knows it to the second.
 *
 * @param {[number, number] | null | undefined} range low and high [s]
 */
export function remaining(range) {
  if (!range) return "";
  const [low, high] = range.map(coarse);
  if (high < 2) return "a moment left";
  const [least, most] = [duration(low), duration(high)];
  if (least === most) return `about ${most} left`;
  // "1 to 3 min", not "1 min to 3 min".
  const [unit, same] = [least, most].map((text) => text.slice(text.lastIndexOf(" ")));
  return `${unit === same ? least.slice(0, -unit.length) : least} to ${most} left`;
}

/**
 * An estimate of a duration, no finer than it deserves.
 *
 * @param {number | null | undefined} seconds
 */
export function roughly(seconds) {
  if (typeof seconds !== "number" || !Number.isFinite(seconds)) return "–";
  return seconds < 1 ? duration(seconds) : `about ${duration(coarse(seconds))}`;
}

/** @param {number} seconds */
function coarse(seconds) {
  if (seconds < 20) return Math.round(seconds);
  if (seconds < 90) return Math.round(seconds / 5) * 5;
  return Math.round(seconds / 60) * 60;
}

/**
 * A size in memory or on disk.
 *
 * @param {number | null | undefined} bytes
 */
export function bytes(bytes) {
  if (bytes === null || bytes === undefined || !Number.isFinite(bytes)) return "–";
  const units = ["B", "kB", "MB", "GB", "TB", "PB"];
  const order = bytes < 1 ? 0 : Math.min(Math.floor(Math.log10(bytes) / 3), units.length - 1);
  return `${number(bytes / 1000 ** order, 2)} ${units[order]}`;
}

/**
 * How long ago something happened.
 *
 * @param {string | null | undefined} when ISO 8601; without a zone it is UTC, as the server's clock
 * @param {number} now [ms]
 */
export function ago(when, now) {
  if (!when) return "";
  const zoned = /([zZ]|[+-]\d\d:?\d\d)$/.test(when) ? when : `${when}Z`;
  const seconds = (now - Date.parse(zoned)) / 1000;
  if (!Number.isFinite(seconds)) return "";
  if (seconds < 45) return "just now";
  if (seconds < 3600) return `${Math.max(1, Math.round(seconds / 60))} min ago`;
  if (seconds < 86400) return `${Math.round(seconds / 3600)} h ago`;
  return `${Math.round(seconds / 86400)} d ago`;
}

/**
 * A verdict's value with as many decimals as it takes not to read as the limit itself, which is how
 * the server's statement writes it.
 *
 * @param {number} value
 * @param {number} limit
 */
export function besideLimit(value, limit) {
  for (let decimals = 2; decimals < 7; decimals += 1) {
    const text = value.toFixed(decimals);
    if (value === limit || Number(text) !== limit) return minus(text);
  }
  return number(value, 9);
}

/** @type {Record<string, string>} */
const STATES = {
  queued: "Queued",
  running: "Running",
  done: "Done",
  failed: "Failed",
  cancelled: "Cancelled",
  timed_out: "Out of time",
  out_of_memory: "Out of memory",
};

/**
 * A state in words.
 *
 * @param {string} state
 */
export function stateText(state) {
  return STATES[state] ?? state;
}

/**
 * A field's name as a label: "line_speed" reads "Line speed".
 *
 * @param {string} name
 */
export function label(name) {
  const words = name.replace(/_/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}
