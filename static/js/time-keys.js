// @ts-check
/** The keys of the instrument: what each does, and in which words the help says so. Pure. */

/** @typedef {"toggle" | "forward" | "back" | "leap-forward" | "leap-back" | "faster" | "slower" | "peak" | "help"} Action */

/** The help, in the order of use. @type {[string[], string][]} */
export const KEY_WORDS = [
  [["Space"], "play or pause"],
  [["←", "→"], "one picture back or forward"],
  [["Shift", "← →"], "ten pictures back or forward"],
  [["[", "]"], "slower or faster"],
  [["P"], "jump to the peak"],
  [["?"], "show these keys"],
  [["click in a plot"], "go to that time"],
  [["drag in a plot"], "zoom; a double click shows the whole run"],
  [["click in the 3D view"], "histories of that point of the deck"],
];

/** @type {Record<string, Action>} */
const PLAIN = { " ": "toggle", ArrowRight: "forward", ArrowLeft: "back", "[": "slower", "]": "faster", p: "peak", P: "peak", "?": "help" };

/** Elements that read letters, arrows or the space bar themselves. */
const OWN = "input:not([type=range]), select, textarea, summary, dialog, [role=tab], [role=menu]";

/**
 * What a key asks of the instrument, null where it is somebody else's.
 *
 * @param {Pick<KeyboardEvent, "key" | "shiftKey" | "ctrlKey" | "metaKey" | "altKey">} event
 * @param {{ closest(selector: string): unknown } | null} target element that has the focus
 * @returns {Action | null}
 */
export function actionOf(event, target) {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  const action = PLAIN[event.key];
  if (!action || target?.closest?.(OWN)) return null;
  if (action === "toggle" && target?.closest?.("button, a, label")) return null;
  if (event.shiftKey && action === "forward") return "leap-forward";
  if (event.shiftKey && action === "back") return "leap-back";
  return action;
}
