// @ts-check
/** A choice of a few, side by side: radio buttons that look like one. */
import { h } from "../dom.js";

let made = 0;

/**
 * @param {{ legend: string, options: [string, string][], chosen: string,
 *   choose: (value: string) => void }} options values and their words
 */
export function segments({ legend, options, chosen, choose }) {
  made += 1;
  const name = `segments-${made}`;
  return h(
    "fieldset",
    { class: "segments" },
    h("legend", { class: "sr" }, legend),
    options.map(([value, text]) =>
      h("label", null, h("input", { type: "radio", name, value, checked: value === chosen, onchange: () => choose(value) }), h("span", null, text)),
    ),
  );
}
