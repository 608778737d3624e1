// @ts-check
/**
 * A viewing session on the server: opened once, steered, switched between runs, closed.
 *
 * Emits `state` with what the server says is shown, and `lost` where the session is no more.
 */
import { api } from "./api.js";

/** @typedef {import("./types.js").ViewerState} ViewerState */
/** @typedef {Partial<Pick<ViewerState, "time" | "playing" | "rate" | "scale" | "layers" | "camera" | "theme" | "colour" | "smooth" | "mode" | "run">> & { place?: [number, number, number] | null, pose?: (import("./types.js").CameraPose & { time?: number }) | null }} Steering */

/** Steering at most this often; the latest value wins. [ms] */
const PACE = 60;
/** How often the state is asked for while nothing is steered. [ms] */
const LOOK = 4000;
/** When to look for the point that a click hit. [ms] */
const PICKS = [80, 180, 350, 700, 1400, 2800];

export class ViewerSession extends EventTarget {
  #id = "";
  #closed = false;
  /** @type {Steering | null} */
  #pending = null;
  #sending = false;
  /** How often it was steered, and how many of these words are answered. */
  #steered = 0;
  #answered = 0;
  /** @type {ReturnType<typeof setInterval> | undefined} */
  #looking;
  /** @type {ViewerState | null} */
  state = null;

  /**
   * Opens it.
   *
   * @param {string} run
   * @param {"light" | "dark"} theme
   * @returns {Promise<string>} address of the page to show
   */
  async open(run, theme) {
    const { session, url } = await api.openViewer(run, { theme });
    this.#id = session;
    if (this.#closed) this.close();
    else this.#looking = setInterval(() => void this.look(), LOOK);
    return url;
  }

  /** @param {Steering} change */
  steer(change) {
    this.#steered += 1;
    this.#pending = { ...this.#pending, ...change };
    if (this.#id && !this.#sending) void this.#send();
  }

  /** Whether the state is of all that was asked for. */
  get settled() {
    return this.#answered === this.#steered;
  }

  async #send() {
    this.#sending = true;
    while (this.#pending && !this.#closed) {
      const change = this.#pending;
      this.#pending = null;
      const steered = this.#steered;
      await this.#take(api.steerViewer(this.#id, change), () => (this.#answered = steered));
      await new Promise((resolve) => setTimeout(resolve, PACE));
    }
    this.#sending = false;
  }

  /** Asks what is shown; a tab in the background does not. */
  async look() {
    if (this.#id && !this.#closed && !document.hidden && this.settled) await this.#take(api.viewer(this.#id));
  }

  /**
   * The point that a click hit, once the server has found it; null where it hit nothing.
   *
   * @returns {Promise<import("./types.js").Picked | null>}
   */
  async pick() {
    const before = this.state?.picked?.sequence ?? 0;
    for (const wait of PICKS) {
      await new Promise((resolve) => setTimeout(resolve, wait));
      await this.look();
      const picked = this.state?.picked;
      if (picked && picked.sequence !== before) return picked;
    }
    return null;
  }

  /**
   * @param {Promise<ViewerState>} answer
   * @param {() => void} [note] counts it before anybody hears of it
   */
  async #take(answer, note) {
    const steered = this.#steered;
    try {
      const state = await answer.finally(note);
      // What was read before somebody steered would turn it back.
      if (this.#closed || (!note && steered !== this.#steered)) return;
      this.state = state;
      this.dispatchEvent(new CustomEvent("state", { detail: state }));
    } catch (error) {
      if (/** @type {any} */ (error).status === 404 && !this.#closed) this.#lose();
    }
  }

  #lose() {
    this.#id = "";
    this.close();
    this.dispatchEvent(new CustomEvent("lost"));
  }

  close() {
    this.#closed = true;
    this.#pending = null;
    clearInterval(this.#looking);
    if (this.#id) void api.closeViewer(this.#id).catch(() => {});
  }
}
