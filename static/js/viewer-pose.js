// @ts-check
/**
 * The camera's place between the address and the viewer: what the address or a choice asks for goes to
 * the viewer once, and what a hand on the camera makes of it comes back once it is at rest.
 */
import { poseNews } from "./viewer-looks.js";

/** @typedef {import("./run-view.js").RunView} RunView */
/** @typedef {import("./viewer-session.js").ViewerSession} ViewerSession */

/** The camera glides on a little after it was let go. [ms] */
const REST = 400;

export class ViewerPose {
  #view;
  /** @type {ViewerSession | null} */
  #session = null;
  /** Whether somebody asks for the place that the shared view says. */
  asks = false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #resting;

  /**
   * @param {RunView} view
   * @param {AbortSignal} signal
   */
  constructor(view, signal) {
    this.#view = view;
    // Who chooses a preset, be it the same again, wants to be there.
    view.addEventListener("change", (event) => (this.asks ||= "camera" in /** @type {CustomEvent} */ (event).detail), { signal });
    signal.addEventListener("abort", () => clearTimeout(this.#resting));
  }

  /** A new session knows of no place yet. @param {ViewerSession} session */
  begin(session) {
    this.#session = session;
    this.asks = this.#view.look.pose !== null;
    session.addEventListener("state", () => this.#take());
  }

  /** The viewer has spoken: it knows of all that was asked, or will say so later. */
  #take() {
    const { settled, state } = /** @type {ViewerSession} */ (this.#session);
    if (!settled || !state) return;
    this.asks = false;
    const news = poseNews(this.#view.look, state);
    if (news) this.#view.set(news);
  }

  /** A hand was on the camera: looks where it is until it stays there. */
  rest() {
    clearTimeout(this.#resting);
    this.#resting = setTimeout(async () => {
      const before = JSON.stringify(this.#session?.state?.pose);
      await this.#session?.look();
      if (before !== JSON.stringify(this.#session?.state?.pose)) this.rest();
    }, REST);
  }
}
