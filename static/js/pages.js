// @ts-check
/**
 * Which page an address asks for. Its code is fetched when it is first asked for; code that cannot
 * be fetched or fails leaves a page that says so.
 */
import { h } from "./dom.js";

/** @typedef {import("./router.js").Route} Route */
/** @typedef {HTMLElement & { route?: Route }} Page knows its address before it is connected */

/** @type {Record<string, () => Promise<new () => Page>>} */
const PAGES = {
  home: async () => (await import("./pages/home-page.js")).HomePage,
  jobs: async () => (await import("./pages/jobs-page.js")).JobsPage,
  job: async () => (await import("./pages/job-page.js")).JobPage,
  study: async () => (await import("./pages/study-page.js")).StudyPage,
  compare: async () => (await import("./pages/compare-page.js")).ComparePage,
  library: async () => (await import("./pages/library-page.js")).LibraryPage,
  report: async () => (await import("./pages/report-page.js")).ReportPage,
};

/**
 * Name of the page of an address, null where there is none. Pure.
 *
 * @param {Route} route
 */
export function pageName(route) {
  const deep = route.parts.length;
  if (route.name === "jobs") return deep === 0 ? "jobs" : deep === 1 ? "job" : null;
  if (route.name === "study") return deep === 1 || (deep === 0 && route.query.has("job")) ? "study" : null;
  if (route.name === "report") return deep === 1 ? "report" : null;
  if (route.name === "library") return deep <= 2 ? "library" : null;
  return (route.name === "home" || route.name === "compare") && deep === 0 ? route.name : null;
}

/**
 * The page of an address, ready to be shown.
 *
 * @param {Route} route
 * @returns {Promise<HTMLElement>}
 */
export async function openPage(route) {
  const name = pageName(route);
  if (name === null) return face("There is no such page", "The address may be mistyped, or from another version of Trainbridge.");
  try {
    const Page = await PAGES[name]();
    const page = new Page();
    page.route = route;
    return page;
  } catch (error) {
    console.error(error);
    return face("This page could not be opened", "Its code did not arrive, or does not fit this version. The server may have stopped.", true);
  }
}

/**
 * @param {string} heading
 * @param {string} words
 * @param {boolean} [again] whether to offer a second try
 */
function face(heading, words, again = false) {
  document.title = `${heading} · Trainbridge`;
  return h(
    "div",
    { class: "card empty" },
    h("h1", null, heading),
    h("p", { class: "soft" }, words),
    h(
      "div",
      { class: "row" },
      again && h("button", { type: "button", class: "primary", onclick: () => location.reload() }, "Try again"),
      h("a", { class: "button", href: "#/" }, "Home"),
    ),
  );
}
