// @ts-check
/** Starts the page: what the server is, which page the address asks for; follows the jobs. */
import "./components/connection.js";
import { HomePage } from "./pages/home-page.js";
import { JobPage } from "./pages/job-page.js";
import { JobsPage } from "./pages/jobs-page.js";
import { StudyPage } from "./pages/study-page.js";
import { api } from "./api.js";
import { h, show } from "./dom.js";
import { JobEvents } from "./events.js";
import { start } from "./router.js";
import { store } from "./store.js";

/** @typedef {import("./router.js").Route} Route */

const main = /** @type {HTMLElement} */ (document.getElementById("main"));
let opened = "";

/**
 * @param {Route} route
 * @returns {HTMLElement}
 */
function page(route) {
  const [first] = route.parts;
  if (route.name === "study" && first) {
    const study = new StudyPage();
    study.template = first;
    return study;
  }
  if (route.name === "jobs" && first) {
    const job = new JobPage();
    job.job = first;
    job.query = route.query;
    return job;
  }
  if (route.name === "jobs") return new JobsPage();
  if (route.name === "home") return new HomePage();
  return h("div", { class: "notice" }, h("p", null, "There is no such page. ", h("a", { href: "#/" }, "Go home.")));
}

/** @param {Route} route */
function open(route) {
  const name = [route.name, ...route.parts].join("/");
  if (name === opened) return;
  const first = opened === "";
  opened = name;
  show(main, page(route));
  for (const item of document.querySelectorAll("nav a[data-route]")) {
    if (item.getAttribute("data-route") === route.name) item.setAttribute("aria-current", "page");
    else item.removeAttribute("aria-current");
  }
  if (!first) {
    scrollTo(0, 0);
    main.focus({ preventScroll: true });
  }
}

const meta = api.meta().catch(() => ({ version: "", plotly_url: "" }));
store.set("meta", meta);
void meta.then((known) => {
  const place = document.getElementById("version");
  if (place && known.version) show(place, `Trainbridge ${known.version}`);
});
new JobEvents(store).start();
start(open);
