// @ts-check
/** The address after # names the page; a shared link opens the same one. Pure but for `start`. */

/**
 * @typedef {{ name: string, parts: string[], query: URLSearchParams }} Route
 */

/**
 * What an address asks for.
 *
 * @param {string} hash
 * @returns {Route}
 */
export function parse(hash) {
  const [path, query = ""] = hash.replace(/^#\/?/, "").split("?");
  const [name, ...parts] = path.split("/").filter(Boolean).map(decode);
  return { name: name || "home", parts, query: new URLSearchParams(query) };
}

/** @param {string} part */
function decode(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

/**
 * The address of a page.
 *
 * @param {...string} parts
 */
export function link(...parts) {
  return `#/${parts.map(encodeURIComponent).join("/")}`;
}

/** What of the query names another page, not another view of the same one. @type {Record<string, string[]>} */
const NAMING = { study: ["job"], compare: ["runs"] };

/**
 * Addresses with the same key show the same page. Pure.
 *
 * @param {Route} route
 */
export function pageKey(route) {
  const named = (NAMING[route.name] ?? []).map((key) => `${key}=${route.query.get(key) ?? ""}`);
  return [route.name, ...route.parts.map(encodeURIComponent), ...named].join("/");
}

/**
 * Remembers a value in the address without a step in the history.
 *
 * @param {string} key
 * @param {string | null} value
 */
export function remember(key, value) {
  const [path, query = ""] = location.hash.split("?");
  const parameters = new URLSearchParams(query);
  if (value === null) parameters.delete(key);
  else parameters.set(key, value);
  const text = parameters.toString();
  history.replaceState(null, "", `${path || "#/"}${text ? `?${text}` : ""}`);
}

/**
 * Opens the page of the address now and whenever the address names another one. What `remember`
 * wrote into the address since counts: a link to the pictures of before opens them again.
 *
 * @param {(route: Route) => void} open
 */
export function start(open) {
  addEventListener("hashchange", ({ oldURL }) => {
    const route = parse(location.hash);
    if (pageKey(route) !== pageKey(parse(new URL(oldURL).hash))) open(route);
  });
  open(parse(location.hash));
}
