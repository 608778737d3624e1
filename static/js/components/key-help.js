// @ts-check
/** The dialog that says what the keys do; `?` opens it, Escape closes it. */
import { h, show } from "../dom.js";
import { KEY_WORDS } from "../time-keys.js";

export class KeyHelp extends HTMLElement {
  #dialog = h("dialog", { "aria-label": "Keys" });

  connectedCallback() {
    show(
      this.#dialog,
      h("h2", null, "Keys"),
      h(
        "dl",
        { class: "keys" },
        KEY_WORDS.map(([keys, words]) =>
          h("div", null, h("dt", null, keys.map((key) => h("kbd", null, key))), h("dd", null, words)),
        ),
      ),
      h("form", { method: "dialog", class: "dialog-actions" }, h("button", { class: "primary" }, "Close")),
    );
    show(this, this.#dialog);
  }

  open() {
    if (!this.#dialog.open) this.#dialog.showModal();
  }
}

customElements.define("tb-key-help", KeyHelp);
