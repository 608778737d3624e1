// @ts-check
/**
 * What is seen where there is no 3D view: pictures that the server draws, at the cursor's time, and
 * the study from the side with the train where it is.
 */
import { Elevation } from "./elevation.js";
import { stillUrl } from "../api.js";
import { h, show } from "../dom.js";
import { store } from "../store.js";
import { currentTheme } from "../theme.js";
import { cameraAsked } from "../viewer-looks.js";

/** @typedef {import("../run-view.js").RunView} RunView */

const WHY = "This browser offers no WebGL, so the server draws the pictures: they follow the time, a little later. The plots below are complete.";
/** A still picture a second is calm, for the eye and for the server. [ms] */
const PACE = 1000;

export class ViewerStills extends HTMLElement {
  #run = "";
  /** @type {RunView | null} */
  #view = null;
  #ended = new AbortController();
  #running = false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #wanted = "";
  /** @type {number | null} */
  #scale = null;
  #image = h("img", { class: "still", alt: "" });
  #side = /** @type {Elevation} */ (h("tb-elevation"));
  #drawing = h("div", { class: "drawing", hidden: true }, this.#side);
  #line = h("p", { class: "small soft" });
  /** @type {{ speed: number, start: number }} */
  #motion = { speed: 0, start: 0 };

  /** @param {{ run: string, view: RunView }} options */
  bind({ run, view }) {
    this.#run = run;
    this.#view = view;
    show(this.#line, "From the side, at the time below.");
    show(this, this.#drawing, this.#line);
    const signal = this.#ended.signal;
    view.cursor.addEventListener("change", (event) => this.#move(/** @type {CustomEvent} */ (event).detail.reason), { signal });
    view.watch(["colour", "scale", "camera", "pose", "mode"], () => this.#follow(), signal);
    store.watch("theme", () => this.#follow(), signal);
    this.#image.addEventListener(
      "load",
      () => {
        this.#image.hidden = false;
        show(this.#line, WHY);
        this.#pause();
      },
      { signal },
    );
    this.#image.addEventListener("error", () => this.#missing(), { signal });
  }

  disconnectedCallback() {
    this.#ended.abort();
    clearTimeout(this.#timer);
  }

  /** @param {string} run */
  set run(run) {
    this.#run = run;
    this.#follow();
  }

  /** A scale that suits the run; what somebody chose counts more. @param {number} scale */
  set scale(scale) {
    this.#scale = scale;
    this.#follow();
  }

  /** The study that is drawn from the side. @param {import("../types.js").Study} study */
  set study(study) {
    this.#side.study = study;
    this.#drawing.hidden = false;
  }

  /**
   * Where the first axle is: start + speed * time.
   *
   * @param {{ speed: number, start: number }} motion [m/s], [m]
   */
  set motion(motion) {
    this.#motion = motion;
    this.#follow();
  }

  /** Asks the server for pictures from now on. */
  start() {
    if (this.#running) return;
    this.#running = true;
    show(this.#line, WHY);
    show(this, this.#image, this.#drawing, this.#line);
    this.#follow();
  }

  /** A place beside the train is left when the train goes on: nobody carries it along here. @param {string} reason */
  #move(reason) {
    const { camera, pose } = /** @type {RunView} */ (this.#view).look;
    if (this.#running && pose && camera === "follow" && reason === "seek") this.#view?.set({ pose: null });
    this.#follow();
  }

  #follow() {
    const view = this.#view;
    if (!view) return;
    if (this.#motion.speed > 0) this.#side.front = this.#motion.start + this.#motion.speed * view.cursor.time;
    if (!this.#running) return;
    const { colour, mode } = view.look;
    const scale = view.look.scale ?? this.#scale;
    this.#wanted = stillUrl(this.#run, {
      time: Number(view.cursor.time.toFixed(4)),
      theme: currentTheme(),
      ...(colour && { colour }),
      ...cameraAsked(view.look, view.cursor.time),
      ...(scale && { scale }),
      ...(mode > 1 && { mode: mode - 1 }),
    });
    if (this.#timer === undefined) this.#fetch();
  }

  #fetch() {
    if (this.#image.getAttribute("src") === this.#wanted) {
      this.#timer = undefined;
      return;
    }
    this.#timer = setTimeout(() => this.#pause(), 10 * PACE);
    this.#image.src = this.#wanted;
    this.#image.alt = `The viaduct and the train at ${this.#view?.cursor.time.toFixed(3)} s`;
  }

  /** The next picture comes after a while. */
  #pause() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#fetch(), PACE);
  }

  #missing() {
    this.#image.hidden = true;
    show(this.#line, "The server cannot draw this picture: other colours may be there.");
    this.#pause();
  }
}

customElements.define("tb-viewer-stills", ViewerStills);
