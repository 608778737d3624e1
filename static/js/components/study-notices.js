// @ts-check
/** What the study page says in words: changes that came back, cells that were refused, what to mend. */
import { h } from "../dom.js";
import { ago } from "../format.js";

/** When a draft was kept that came back [ms], and the way back. @typedef {{ resumed: number | null, restart: () => void }} Resumed */

/** Cells that are named; the others are counted. */
const NAMED = 6;

/**
 * Changes of a visit before, and the way back to the beginning.
 *
 * @param {Resumed} model
 * @param {string} called where it came from
 * @param {() => void} close
 */
export function resumedNotice(model, called, close) {
  if (model.resumed === null) return null;
  const when = ago(new Date(model.resumed).toISOString(), Date.now());
  const restart = () => {
    model.restart();
    close();
  };
  return h(
    "div",
    { class: "notice" },
    h(
      "p",
      null,
      `Your changes of ${when === "just now" ? "a moment ago" : when} are back. `,
      h("button", { type: "button", class: "link", onclick: restart }, `Begin again from ${called}`),
    ),
  );
}

/** @param {string[]} refused */
export function leftAsTheyWere(refused) {
  const more = refused.length - NAMED;
  return h(
    "div",
    { class: "notice wait" },
    h(
      "div",
      null,
      h("p", null, "Pasted. These cells were left as they were:"),
      h("ul", null, refused.slice(0, NAMED).map((text) => h("li", null, text)), more > 0 && h("li", null, `and ${more} more`)),
    ),
  );
}

/**
 * Which inputs to mend; each leads there.
 *
 * @param {{ name: string, focus: () => void }[]} places
 * @returns {import("../dom.js").Child}
 */
export function toMend(places) {
  if (!places.length) return "Mend what is said below first.";
  const links = places.map(({ name, focus }) => h("button", { type: "button", class: "link", onclick: focus }, name));
  return ["To mend first: ", links.flatMap((item, index) => (index ? [", ", item] : [item]))];
}
