// @ts-check
/** Starts the page: what the server is, which page the address asks for; follows the jobs. */
import "./components/connection.js";
import "./components/theme-switch.js";
import { api } from "./api.js";
import { show } from "./dom.js";
import { JobEvents } from "./events.js";
import { openPage } from "./pages.js";
import { start } from "./router.js";
import { store } from "./store.js";
import { followTheme } from "./theme.js";

/** @typedef {import("./router.js").Route} Route */

const main = /** @type {HTMLElement} */ (document.getElementById("main"));
/** @type {Route | null} */
let asked = null;

/** @param {Route} route */
async function open(route) {
  const first = asked === null;
  asked = route;
  for (const item of document.querySelectorAll("nav a[data-route]")) {
    if (item.getAttribute("data-route") === route.name) item.setAttribute("aria-current", "page");
    else item.removeAttribute("aria-current");
  }
  const page = await openPage(route);
  if (asked !== route) return; // the visitor was faster than the code
  show(main, page);
  if (!first) {
    scrollTo(0, 0);
    main.focus({ preventScroll: true });
  }
}

followTheme();
const meta = api.meta().catch(() => ({ version: "", plotly_url: "" }));
store.set("meta", meta);
void meta.then((known) => {
  const place = document.getElementById("version");
  if (place && known.version) show(place, `Trainbridge ${known.version}`);
});
new JobEvents(store).start();
document.querySelector(".skip")?.addEventListener("click", (event) => {
  event.preventDefault(); // the address after # is ours
  main.focus();
});
start((route) => void open(route));
