// @ts-check
/** A question before something is lost. */
import { h } from "../dom.js";

/**
 * Asks, and says whether the answer was yes. Escape means no.
 *
 * @param {{ question: string, words: string, action: string }} options
 * @returns {Promise<boolean>}
 */
export function confirmed({ question, words, action }) {
  const dialog = h(
    "dialog",
    { "aria-label": question },
    h("h2", null, question),
    h("p", { class: "soft" }, words),
    h(
      "form",
      { method: "dialog", class: "dialog-actions" },
      h("button", { value: "no", autofocus: true }, "Keep"),
      h("button", { value: "yes", class: "danger" }, action),
    ),
  );
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
  });
}
