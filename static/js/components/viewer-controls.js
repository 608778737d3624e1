// @ts-check
/**
 * What the 3D view shows and how: layers, colours, scale, camera. Writes into the shared view;
 * saves what is shown as a picture or as a replay.
 */
import { replayUrl, stillUrl } from "../api.js";
import { h, show } from "../dom.js";
import { label } from "../format.js";
import { currentTheme } from "../theme.js";
import { poseText } from "../view-address.js";
import { cameraShown, steadyPose } from "../viewer-looks.js";

/** @typedef {import("../run-view.js").RunView} RunView */
/** @typedef {import("../types.js").ViewerState} ViewerState */

const SCALES = [1, 10, 20, 50, 100, 200, 500, 1000];
/** Of a mode, parts of the scale that the viewer chose. */
const PARTS = [0.25, 0.5, 1, 2, 4];
/** @type {Record<string, string>} */
const CAMERAS = {
  overview: "overview",
  side: "from the side",
  section: "section at mid-span",
  follow: "follow the first bogie",
  free: "free",
};
/** @type {Record<string, string>} */
const COLOURS = {
  none: "by material",
  displacement: "by displacement",
  velocity: "by velocity",
  acceleration: "by acceleration",
  peak: "by greatest |acceleration|",
};

export class ViewerControls extends HTMLElement {
  /** @type {RunView | null} */
  #view = null;
  #scale = this.#select("Scale of the deformation", (value) => this.#view?.set({ scale: Number(value) }));
  #camera = this.#select("Camera", (value) => this.#view?.set({ camera: value, pose: null }));
  #colour = this.#select("Colours", (value) => this.#view?.set({ colour: value }));
  #layers = h("details", { class: "drop", hidden: true });
  /** The viewer's own scale of a mode, whose size means nothing. */
  #own = 0;
  /** A scale that suits the run, where the server draws. @type {number | null} */
  #plain = null;
  /** What the menus offer now, so that they are not built again under somebody's hand. */
  #offered = "";

  /** Id of the run. */
  run = "";
  /** @type {ViewerState | null} */
  #state = null;

  /** @param {{ run: string, view: RunView }} options */
  bind({ run, view }) {
    this.run = run;
    this.#view = view;
    this.className = "row viewer-controls";
    const save = (/** @type {string} */ words, /** @type {() => string} */ url) =>
      h("button", { type: "button", class: "quiet", onclick: () => h("a", { href: url(), download: "" }).click() }, words);
    show(
      this,
      this.#colour,
      this.#scale,
      this.#camera,
      this.#layers,
      h("span", { class: "row save" }, save("Save picture", () => this.#picture()), save("Save replay", () => this.#replay())),
    );
    options(this.#camera, CAMERAS);
    this.#layers.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.#layers.open = false;
    });
  }

  /**
   * Shows what the server says is shown.
   *
   * @param {ViewerState} state
   */
  set state(state) {
    this.#state = state;
    if (state.modal) this.#own ||= state.scale;
    const usual = state.modal ? PARTS.map((part) => Number((part * this.#own).toPrecision(3))) : SCALES;
    const scales = [...new Set([...usual, state.scale])].sort((a, b) => a - b);
    const offer = JSON.stringify([scales, state.available_layers, state.modal]);
    if (offer !== this.#offered) {
      this.#offered = offer;
      options(this.#scale, Object.fromEntries(scales.map((value) => [value, state.modal ? `amplitude ${value} m` : `deformation × ${value}`])));
      this.#offerLayers(state);
    }
    const colours = state.available_colours;
    if (this.#colour.options.length !== colours.length) {
      options(this.#colour, Object.fromEntries(colours.map((name) => [name, COLOURS[name] ?? name])));
    }
    for (const [select, value] of /** @type {const} */ ([[this.#scale, state.scale], [this.#camera, cameraShown(state)], [this.#colour, state.colour]])) {
      if (document.activeElement !== select && value !== undefined) select.value = String(value);
    }
  }

  /**
   * Where the server draws instead: colours, camera, scale and pictures to keep.
   *
   * @param {number} scale that suits the run
   */
  set plain(scale) {
    this.#plain = scale;
    const look = this.#view?.look;
    const shown = { scale: look?.scale ?? scale, camera: look?.camera || "overview", pose: look?.pose ?? null, colour: look?.colour || "none" };
    this.state = /** @type {any} */ ({ ...shown, layers: [], available_layers: [], available_colours: Object.keys(COLOURS) });
  }

  /** How the view looks now, as an address asks for it. */
  #look() {
    const state = /** @type {ViewerState} */ (this.#state);
    const { scale, colour, camera, modal, mode } = state;
    const pose = this.#plain === null ? steadyPose(state) : this.#view?.look.pose;
    return { scale, colour, theme: currentTheme(), ...(camera !== "free" && { camera }), ...(pose && { pose: poseText(pose) }), ...(modal && { mode }) };
  }

  #picture() {
    return stillUrl(this.run, { time: this.#view?.cursor.time ?? 0, ...this.#look() });
  }

  /** What is zoomed to; the whole run where nothing is. */
  #replay() {
    const part = this.#state?.modal ? {} : (this.#view?.look.window ?? {});
    const { pose, ...look } = this.#look();
    // A place beside the train is there at one time only.
    return replayUrl(this.run, { ...part, ...look, ...(pose && look.camera !== "follow" && { pose }) });
  }

  /** @param {ViewerState} state */
  #offerLayers({ available_layers: names, layers }) {
    const boxes = names.map((name) => h("input", { type: "checkbox", value: name, checked: layers.includes(name), onchange: () => hide() }));
    const hide = () => this.#view?.set({ hidden: boxes.filter((box) => !box.checked).map((box) => box.value) });
    this.#layers.hidden = names.length === 0;
    show(
      this.#layers,
      h("summary", { class: "button" }, "Layers"),
      h("div", { class: "card drop-sheet" }, boxes.map((box) => h("label", null, box, label(box.value)))),
    );
  }

  /**
   * @param {string} words
   * @param {(value: string) => void} choose
   */
  #select(words, choose) {
    const chosen = () => {
      choose(select.value);
      if (this.#plain !== null) this.plain = this.#plain;
    };
    const select = h("select", { "aria-label": words, onchange: chosen });
    return select;
  }
}

/**
 * @param {HTMLSelectElement} select
 * @param {Record<string, string>} choices value to words
 */
function options(select, choices) {
  const before = select.value;
  const order = Object.entries(choices).sort(([a], [b]) => (Number(a) - Number(b)) || 0);
  show(select, order.map(([value, words]) => h("option", { value, selected: value === before }, words)));
}

customElements.define("tb-viewer-controls", ViewerControls);
