// @ts-check
/**
 * The event stream: jobs as they change go into the store of every open tab.
 *
 * Browsers allow six connections to a server over HTTP/1.1, whatever the number of tabs: with one
 * stream a tab, the seventh tab could not even load. So one tab holds the stream, elected by a Web
 * Lock that the browser hands on when that tab closes, and tells the others over a
 * BroadcastChannel. EventSource reconnects by itself; the store's `connected` says whether it is.
 */
import { eventsUrl } from "./api.js";

/** @typedef {import("./store.js").Store} Store */

/** A stream that stays shut this long is news; a shorter gap is not. [ms] */
const PATIENCE = 1500;
/** EventSource gives up after an HTTP error; then we start again after this. [ms] */
const RETRY = 3000;
/** Name of the lock and of the channel. */
const NAME = "trainbridge-events";

export class JobEvents {
  /** @type {EventSource | null} */
  #source = null;
  /** @type {BroadcastChannel | null} */
  #channel = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  /** @param {Store} store */
  constructor(store) {
    this.store = store;
  }

  /** Follows all jobs, through this tab's own stream or another tab's. */
  start() {
    // Both exist on secure origins only; loopback is one, a plain http address elsewhere is not.
    if (!navigator.locks || !("BroadcastChannel" in globalThis)) {
      this.#open();
      return;
    }
    this.#channel = new BroadcastChannel(NAME);
    this.#channel.onmessage = ({ data }) => this.#heard(data);
    this.#channel.postMessage({ hello: true });
    navigator.locks.request(NAME, () => {
      this.#open();
      return new Promise(() => {}); // held until this tab closes
    });
  }

  /** @param {{ hello?: boolean, job?: any, connected?: boolean }} message */
  #heard(message) {
    if (message.hello && this.#source) this.#tell({ connected: this.store.get("connected") });
    if (this.#source) return;
    if (message.job) this.#take(message.job);
    if (typeof message.connected === "boolean") this.store.set("connected", message.connected);
  }

  /** @param {{ job?: any, connected?: boolean }} message */
  #tell(message) {
    this.#channel?.postMessage(message);
  }

  #open() {
    const source = new EventSource(eventsUrl([]));
    this.#source = source;
    source.onopen = () => this.#setConnected(true);
    source.onerror = () => {
      // From the first failure on: every further attempt fails too, within the patience.
      this.#timer ??= setTimeout(() => this.#publish(false), PATIENCE);
      if (source.readyState === EventSource.CLOSED) setTimeout(() => this.#open(), RETRY);
    };
    source.addEventListener("job", (event) => {
      this.#setConnected(true);
      const job = JSON.parse(event.data);
      this.#take(job);
      this.#tell({ job });
    });
  }

  /** @param {any} job */
  #take(job) {
    this.store.set(`job:${job.id}`, job);
    this.store.set("job", job);
  }

  /** @param {boolean} connected */
  #setConnected(connected) {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    if (this.store.get("connected") !== connected) this.#publish(connected);
  }

  /** @param {boolean} connected */
  #publish(connected) {
    this.store.set("connected", connected);
    this.#tell({ connected });
  }
}
