// @ts-check
// Runs before the first paint, and therefore is no module: a dark page must not flash white.
(() => {
  let choice = null;
  try {
    choice = localStorage.getItem("trainbridge-theme");
  } catch {
    // Storage is shut: the system's wish it is.
  }
  const dark = choice === "dark" || (choice !== "light" && matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
})();
