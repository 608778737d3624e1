// @ts-check
/** JSON text with the line of every value, and plain words where it is broken. Pure. */
import { keyed } from "./pointer.js";

/** Deeper texts are refused, for the reader calls itself. */
const DEEPEST = 60;

/** @typedef {{ line: number, column: number, message: string }} SourceError lines and columns from 1 */
/**
 * @typedef {{ value: any, lines: Map<string, number>, error: null }
 *   | { value: undefined, lines: Map<string, number>, error: SourceError }} Source
 */

class Broken extends Error {
  /**
   * @param {string} message
   * @param {number} position
   */
  constructor(message, position) {
    super(message);
    this.position = position;
  }
}

/**
 * Reads JSON and remembers on which line each pointer stands.
 *
 * @param {string} text
 * @returns {Source}
 */
export function read(text) {
  const reader = new Reader(text);
  try {
    return { value: reader.all(), lines: reader.lines, error: null };
  } catch (error) {
    if (!(error instanceof Broken)) throw error;
    const before = text.slice(0, error.position).split("\n");
    const column = before[before.length - 1].length + 1;
    return { value: undefined, lines: reader.lines, error: { line: before.length, column, message: error.message } };
  }
}

/**
 * The line of a pointer, or of the nearest place around it.
 *
 * @param {Map<string, number>} lines
 * @param {string} pointer a leading /study is the envelope's
 */
export function lineOf(lines, pointer) {
  let place = lines.has("/study") ? pointer : pointer.replace(/^\/study(?=\/|$)/, "");
  while (place && !lines.has(place)) place = place.slice(0, place.lastIndexOf("/"));
  return lines.get(place) ?? 1;
}

class Reader {
  #position = 0;
  #line = 1;
  /** @type {Map<string, number>} */
  lines = new Map();

  /** @param {string} text */
  constructor(text) {
    this.text = text;
  }

  all() {
    const value = this.#value("", 0);
    this.#space();
    if (this.#position < this.text.length) throw this.#broken("Nothing may follow the study's last bracket");
    return value;
  }

  /**
   * @param {string} pointer
   * @param {number} depth
   * @returns {any}
   */
  #value(pointer, depth) {
    this.#space();
    if (!this.lines.has(pointer)) this.lines.set(pointer, this.#line);
    if (depth > DEEPEST) throw this.#broken("The brackets are nested too deeply");
    const mark = this.text[this.#position];
    if (mark === "{") return this.#object(pointer, depth);
    if (mark === "[") return this.#list(pointer, depth);
    if (mark === '"') return this.#string();
    return this.#word();
  }

  /**
   * @param {string} pointer
   * @param {number} depth
   */
  #object(pointer, depth) {
    /** @type {Record<string, any>} */
    const found = {};
    this.#position += 1;
    if (this.#take("}")) return found;
    do {
      this.#space();
      if (this.text[this.#position] !== '"') throw this.#broken('Expected a name in quotes, for example "spans"');
      const [start, line] = [this.#position, this.#line];
      const key = this.#string();
      if (Object.hasOwn(found, key)) throw new Broken(`"${key}" stands here twice`, start);
      this.lines.set(keyed(pointer, key), line);
      if (!this.#take(":")) throw this.#broken(`Expected a colon after "${key}"`);
      Object.defineProperty(found, key, { value: this.#value(keyed(pointer, key), depth + 1), enumerable: true, writable: true, configurable: true });
    } while (this.#take(","));
    if (!this.#take("}")) throw this.#broken("Expected a comma or }");
    return found;
  }

  /**
   * @param {string} pointer
   * @param {number} depth
   */
  #list(pointer, depth) {
    /** @type {any[]} */
    const found = [];
    this.#position += 1;
    if (this.#take("]")) return found;
    do found.push(this.#value(keyed(pointer, found.length), depth + 1));
    while (this.#take(","));
    if (!this.#take("]")) throw this.#broken("Expected a comma or ]");
    return found;
  }

  #string() {
    const rest = this.text.slice(this.#position);
    const [token] = /^"(?:[^"\\\n]|\\.)*"/.exec(rest) ?? [];
    if (!token) throw this.#broken("This text has no closing quote on its line");
    return this.#parsed(token);
  }

  #word() {
    const [token = ""] = /^[^\s,:[\]{}"]+/.exec(this.text.slice(this.#position)) ?? [];
    if (!token) throw this.#broken("Expected a value");
    return this.#parsed(token);
  }

  /** @param {string} token */
  #parsed(token) {
    try {
      const value = JSON.parse(token);
      this.#position += token.length;
      return value;
    } catch {
      throw this.#broken(`${token.slice(0, 30)} is no number, text in quotes, true, false or null`);
    }
  }

  /** @param {string} mark */
  #take(mark) {
    this.#space();
    if (this.text[this.#position] !== mark) return false;
    this.#position += 1;
    return true;
  }

  #space() {
    while (/\s/.test(this.text[this.#position] ?? "")) {
      if (this.text[this.#position] === "\n") this.#line += 1;
      this.#position += 1;
    }
  }

  /** @param {string} message */
  #broken(message) {
    return new Broken(this.#position >= this.text.length ? "The text ends too early: a bracket or quote is missing" : message, this.#position);
  }
}
