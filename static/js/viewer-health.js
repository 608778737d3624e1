// @ts-check
/** Whether an embedded view lacks something that it will not get by itself. Pure. */

/** @typedef {import("./types.js").ViewerState} ViewerState */

/** What is missing for more looks than this stays missing. */
const PATIENCE = 2;

export class ViewerHealth {
  #alone = 0;
  #plain = 0;
  #paused = false;

  /**
   * Judges another look.
   *
   * @param {Pick<ViewerState, "clients" | "colour" | "smooth" | "paused">} state as the server tells it
   * @param {boolean | null | undefined} coloured whether the page shows colours per vertex; null
   *   while nobody can tell
   * @returns {{ wake: boolean, simplify: boolean, halted: boolean, resumed: boolean }} whether to have
   *   the page connect again; whether to colour by element instead; whether the server has just
   *   stopped the view that has played longest for another one, or just let it go on
   */
  examine({ clients, colour, smooth, paused }, coloured) {
    const plain = colour !== "none" && smooth && clients > 0 && coloured === false;
    this.#alone = clients > 0 ? 0 : this.#alone + 1;
    this.#plain = plain ? this.#plain + 1 : 0;
    const before = this.#paused;
    this.#paused = paused !== "";
    return {
      wake: this.#alone > PATIENCE,
      simplify: this.#plain > PATIENCE,
      halted: this.#paused && !before,
      resumed: before && !this.#paused,
    };
  }
}
