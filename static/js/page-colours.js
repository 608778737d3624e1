// @ts-check
/** The page's colours and type as a chart needs them: read from the style sheet's custom properties. */
import { currentTheme } from "./theme.js";

/** @returns {import("./chart-theme.js").Theme} */
export function pageColours() {
  const style = getComputedStyle(document.documentElement);
  const read = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  return {
    dark: currentTheme() === "dark",
    ink: read("--ink"),
    soft: read("--ink-soft"),
    line: read("--line"),
    paper: read("--card"),
    type: read("--type"),
  };
}
