// @ts-check
/**
 * The one time of the page: plots, slider and 3D view follow it. The page owns the time, not the
 * viewer.
 */

/** @typedef {{ time: number, playing: boolean, rate: number }} CursorState */

/** Seconds of the run in a second of the clock, slow motion first. */
export const RATES = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1];

export class TimeCursor extends EventTarget {
  /** @type {number} Least time. [s] */
  start = 0;
  /** @type {number} Greatest time. [s] */
  end = 0;
  /** @type {boolean} Whether the 3D view and the plots move by themselves. */
  playing = false;
  /** @type {number} Seconds of the run in a second of the clock. */
  rate = 0.1;
  /** Time between two pictures of the 3D view; a step moves by it. [s] */
  interval = 0;
  /** Whether the end leads to the start: a mode's shape swings on and on. */
  looping = false;
  #time = 0;
  /** @type {number | null} */
  #last = null;

  get time() {
    return this.#time;
  }

  /** @returns {CursorState} */
  get state() {
    return { time: this.#time, playing: this.playing, rate: this.rate };
  }

  /**
   * The range of the run; the time stays inside it.
   *
   * @param {number} start
   * @param {number} end
   */
  setRange(start, end) {
    this.start = start;
    this.end = Math.max(start, end);
    this.#move(this.#time, "range");
  }

  /**
   * Goes to a time, as somebody asked.
   *
   * @param {number} time
   */
  seek(time) {
    this.#move(time, "seek");
  }

  /**
   * Goes to a time that the page proposes: the tip of a running computation, a peak.
   *
   * @param {number} time
   */
  follow(time) {
    if (!this.playing) this.#move(time, "follow");
  }

  /**
   * Stops, and goes on by whole pictures.
   *
   * @param {number} pictures negative: back
   */
  step(pictures) {
    this.pause();
    const interval = this.interval || (this.end - this.start) / 1000;
    if (interval <= 0) return;
    this.#move((Math.round(this.#time / interval) + pictures) * interval, "seek");
  }

  /** Starts; from the beginning where the end was reached. */
  play() {
    if (this.end <= this.start) return;
    if (this.#time >= this.end) this.#move(this.start, "seek");
    this.playing = true;
    this.#last = null;
    this.#tell("play");
  }

  /** Stops where it is. */
  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.#tell("pause");
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /**
   * The next of the usual rates.
   *
   * @param {1 | -1} direction faster or slower
   */
  changeRate(direction) {
    const next = direction > 0 ? RATES.find((rate) => rate > this.rate) : RATES.findLast((rate) => rate < this.rate);
    if (next) this.setRate(next);
  }

  /** @param {number} rate */
  setRate(rate) {
    this.rate = rate;
    this.#tell("rate");
  }

  /**
   * Moves on while playing; call it once a picture.
   *
   * @param {number} now [ms]
   */
  tick(now) {
    if (!this.playing) return;
    const passed = this.#last === null ? 0 : (now - this.#last) / 1000;
    this.#last = now;
    // A tab in the background gets no pictures: it goes on where it was, without a jump.
    const next = this.#time + Math.min(passed, 0.25) * this.rate;
    const length = this.end - this.start;
    this.#move(this.looping && next >= this.end ? this.start + ((next - this.start) % length) : next, "tick");
    if (this.#time >= this.end) this.pause();
  }

  /**
   * @param {number} time
   * @param {string} reason
   */
  #move(time, reason) {
    if (!Number.isFinite(time)) return;
    this.#time = Math.min(Math.max(time, this.start), this.end);
    this.#tell(reason);
  }

  /** @param {string} reason */
  #tell(reason) {
    this.dispatchEvent(new CustomEvent("change", { detail: { ...this.state, reason } }));
  }
}
