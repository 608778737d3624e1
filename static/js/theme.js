// @ts-check
/**
 * Light or dark: what the system asks for, unless the visitor chose otherwise.
 *
 * The store's `theme` is what is shown, "light" or "dark"; `themeChoice` is what was chosen,
 * "light", "dark" or "system". css/tokens.css follows `data-theme` of the document's element,
 * which js/first-paint.js sets before anything is drawn.
 */
import { store } from "./store.js";

/** @typedef {"light" | "dark"} Theme */
/** @typedef {Theme | "system"} ThemeChoice */

/** Where the choice is kept; js/first-paint.js reads it too. */
const KEY = "trainbridge-theme";
/** @type {ThemeChoice[]} */
export const CHOICES = ["light", "dark", "system"];

/**
 * What to show. Pure.
 *
 * @param {ThemeChoice} choice
 * @param {boolean} systemDark
 * @returns {Theme}
 */
export function resolved(choice, systemDark) {
  if (choice === "system") return systemDark ? "dark" : "light";
  return choice;
}

/**
 * A stored text as a choice; whatever else lies there means the system's. Pure.
 *
 * @param {string | null} text
 * @returns {ThemeChoice}
 */
export function asChoice(text) {
  return CHOICES.find((choice) => choice === text) ?? "system";
}

/** @returns {Theme} what is shown now */
export function currentTheme() {
  return store.get("theme") ?? "light";
}

/** @param {ThemeChoice} choice */
export function chooseTheme(choice) {
  try {
    localStorage.setItem(KEY, choice);
  } catch {
    // A browser that keeps nothing still shows the choice until the page is left.
  }
  apply(choice);
}

/** Follows the choice, the system and other tabs. */
export function followTheme() {
  apply(stored());
  systemDark().addEventListener("change", () => apply(store.get("themeChoice")));
  addEventListener("storage", ({ key }) => {
    if (key === KEY || key === null) apply(stored());
  });
}

/** @param {ThemeChoice} choice */
function apply(choice) {
  const theme = resolved(choice, systemDark().matches);
  document.documentElement.dataset.theme = theme;
  if (store.get("themeChoice") !== choice) store.set("themeChoice", choice);
  if (store.get("theme") !== theme) store.set("theme", theme);
}

function systemDark() {
  return matchMedia("(prefers-color-scheme: dark)");
}

/** @returns {ThemeChoice} */
function stored() {
  try {
    return asChoice(localStorage.getItem(KEY));
  } catch {
    return "system";
  }
}
