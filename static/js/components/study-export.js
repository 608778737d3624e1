// @ts-check
/** The study as curl, command line or Python, to copy. A dialog. */
import { exportsOf } from "../code-export.js";
import { h, show } from "../dom.js";

/** @typedef {import("../code-export.js").Order} Order */

export class StudyExport extends HTMLElement {
  #dialog = h("dialog", { class: "card export", "aria-labelledby": "export-title" });
  #chosen = "curl";

  connectedCallback() {
    show(this, this.#dialog);
  }

  /** @param {Order} order */
  open(order) {
    const ways = exportsOf(order.kind);
    const way = ways.find((item) => item.name === this.#chosen) ?? ways[0];
    const text = way.text(order);
    const said = h("span", { class: "soft small", role: "status" });
    show(
      this.#dialog,
      h("div", { class: "row spread" },
        h("h2", { id: "export-title" }, "This study elsewhere"),
        h("button", { type: "button", class: "quiet", onclick: () => this.#dialog.close() }, "Close")),
      h("div", { class: "choices", role: "radiogroup", "aria-label": "Way" }, ways.map((item) =>
        h("label", { class: "choice" },
          h("input", { type: "radio", name: "export", value: item.name, checked: item === way, onchange: () => this.#choose(item.name, order) }),
          item.title))),
      h("p", { class: "soft" }, way.note),
      h("pre", { class: "mono code", tabindex: "0", "aria-label": way.title }, text),
      h("div", { class: "row" },
        h("button", { type: "button", class: "primary", onclick: () => void copy(text, said, this.#dialog) }, "Copy"),
        said),
    ); // prettier-ignore
    if (!this.#dialog.open) this.#dialog.showModal();
  }

  /**
   * @param {string} name
   * @param {Order} order
   */
  #choose(name, order) {
    this.#chosen = name;
    this.open(order);
    /** @type {HTMLElement | null} */ (this.#dialog.querySelector(`input[value="${name}"]`))?.focus();
  }
}

/**
 * Browsers give the clipboard to pages of this machine and of https only; elsewhere the text is
 * selected.
 *
 * @param {string} text
 * @param {Element} said
 * @param {Element} around
 */
async function copy(text, said, around) {
  try {
    await navigator.clipboard.writeText(text);
    show(said, "Copied.");
  } catch {
    const code = around.querySelector("pre");
    if (code) getSelection()?.selectAllChildren(code);
    show(said, "Selected: copy it with Ctrl+C.");
  }
}

customElements.define("tb-study-export", StudyExport);
