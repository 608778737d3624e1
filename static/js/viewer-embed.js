// @ts-check
/**
 * The viewer's page in a frame of our own origin. Emits `ready` when it is loaded and `press` after
 * a click that was no turning of the view, `turn` after everything that may have been one; passes the instrument's keys on to the page.
 */
import { h } from "./dom.js";

/** A pointer that moved further between press and release turned the view. [px] */
const STILL = 5;

export class ViewerEmbed extends EventTarget {
  element;

  /** @param {string} url */
  constructor(url) {
    super();
    this.element = h("iframe", { src: url, title: "3D view of the viaduct and the train", allow: "fullscreen" });
    this.element.addEventListener("load", () => {
      this.wake();
      this.#listen();
      this.dispatchEvent(new CustomEvent("ready"));
    });
  }

  /** An unfocused frame does not reconnect by itself after a gap. */
  wake() {
    const frame = this.element;
    const before = document.activeElement;
    if (!frame.isConnected || before === frame) return;
    frame.contentWindow?.focus();
    if (before instanceof HTMLElement && before !== document.body) before.focus({ preventScroll: true });
    else frame.blur();
  }

  /**
   * Whether the viewer's page shows colours per vertex, as its own test says; null while nobody can
   * tell, because the page is not drawn.
   *
   * @returns {boolean | null}
   */
  get smooth() {
    const report = /** @type {any} */ (this.element.contentWindow)?.trainbridgeColours;
    if (!report || !this.element.checkVisibility()) return null;
    return report.ok && report.coloured.length > 0;
  }

  #listen() {
    const inside = this.element.contentDocument;
    let pressed = { x: Number.NaN, y: Number.NaN };
    inside?.addEventListener("pointerdown", ({ clientX: x, clientY: y }) => (pressed = { x, y }), { capture: true });
    inside?.addEventListener(
      "pointerup",
      ({ clientX: x, clientY: y }) => {
        const still = Math.hypot(x - pressed.x, y - pressed.y) < STILL;
        this.dispatchEvent(new CustomEvent(still ? "press" : "turn"));
      },
      { capture: true },
    );
    for (const kind of ["wheel", "keyup", "dblclick"]) {
      inside?.addEventListener(kind, () => this.dispatchEvent(new CustomEvent("turn")), { capture: true, passive: true });
    }
    inside?.addEventListener("keydown", (event) => this.#pass(event));
  }

  /** The arrows turn the view while it has the focus; the other keys are the page's. @param {KeyboardEvent} event */
  #pass({ key, ctrlKey, metaKey, altKey, target }) {
    const typing = /** @type {Element | null} */ (target)?.closest?.("input, textarea, select, button");
    if (typing || key.startsWith("Arrow")) return;
    dispatchEvent(new KeyboardEvent("keydown", { key, ctrlKey, metaKey, altKey, cancelable: true }));
  }
}
