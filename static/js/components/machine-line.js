// @ts-check
/** The machine that computes: what it has, what of it is free, what is wrong with it. */
import { h, show } from "../dom.js";
import { bytes, number } from "../format.js";

/** @typedef {import("../types.js").Machine} Machine */

/** What the engines are called. @type {Record<string, string>} */
const ENGINES = { local: "this machine", dask: "Dask workers" };

export class MachineLine extends HTMLElement {
  /** @param {Machine} machine */
  set machine(machine) {
    const computes = ENGINES[machine.engine] ?? machine.engine;
    this.classList.add("card", "panel");
    show(
      this,
      h("h2", null, "Machine"),
      machine.trouble && h("div", { class: "notice bad", role: "alert" }, h("p", null, machine.trouble)),
      h(
        "dl",
        { class: "pairs" },
        pair("Cores", number(machine.cores)),
        pair("Computes", `${number(machine.workers)} run${machine.workers === 1 ? "" : "s"} at once, on ${computes}`),
        pair("Memory free", `${bytes(machine.memory_available_bytes)} of ${bytes(machine.memory_bytes)}`),
        pair("Disk free", bytes(machine.disk_free_bytes)),
      ),
    );
  }
}

/**
 * @param {string} term
 * @param {string} text
 */
function pair(term, text) {
  return h("div", null, h("dt", null, term), h("dd", null, text));
}

customElements.define("tb-machine", MachineLine);
