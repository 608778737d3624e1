// @ts-check
/** The same study as a command or a program, ready to paste. Pure. */

/** @typedef {import("./types.js").Study} Study */
/** @typedef {{ study: Study, kind: string, origin: string }} Order what is sent, and to which server */
/** @typedef {{ name: string, title: string, note: string, text: (order: Order) => string }} Export */

const INDENT = 2;

/** @param {unknown} value */
const json = (value) => JSON.stringify(value, null, INDENT);

/** @param {Order} order */
function curl({ study, kind, origin }) {
  return [
    `curl --fail-with-body ${origin}/api/v1/jobs \\`,
    `  \${TRAINBRIDGE_TOKEN:+--oauth2-bearer "$TRAINBRIDGE_TOKEN"} \\`,
    "  --header 'Content-Type: application/json' \\",
    "  --data-binary @- <<'STUDY'",
    json({ kind, study }),
    "STUDY",
    "",
  ].join("\n");
}

/** @param {Order} order */
function submit({ study, kind, origin }) {
  return [`trainbridge submit - --server ${origin} --kind ${kind} --wait <<'STUDY'`, json(study), "STUDY", ""].join("\n");
}

/** @param {Order} order */
function run({ study }) {
  return ["trainbridge run - --out results <<'STUDY'", json(study), "STUDY", ""].join("\n");
}

/** @param {Order} order */
function python({ study, kind, origin }) {
  return [
    "from server.client import TrainbridgeClient",
    "",
    `study = ${literal(study, "")}`,
    "",
    `with TrainbridgeClient.from_environment(${JSON.stringify(origin)}) as client:`,
    `    job = client.submit(study, kind=${JSON.stringify(kind)})`,
    "    job = client.wait(job.id)",
    "    print(job.state, [run.id for run in job.runs])",
    "",
  ].join("\n");
}

/**
 * A plain value as Python writes it; its strings read as JSON's do.
 *
 * @param {any} value
 * @param {string} margin
 * @returns {string}
 */
export function literal(value, margin) {
  if (value === null || value === undefined) return "None";
  if (value === true) return "True";
  if (value === false) return "False";
  if (typeof value !== "object") return JSON.stringify(value);
  const inner = `${margin}    `;
  const entries = Array.isArray(value)
    ? value.map((item) => literal(item, inner))
    : Object.entries(value).map(([key, item]) => `${JSON.stringify(key)}: ${literal(item, inner)}`);
  const [open, close] = Array.isArray(value) ? "[]" : "{}";
  const plain = Array.isArray(value) && value.every((item) => typeof item !== "object");
  if (!entries.length || (plain && entries.join(", ").length < 70)) return `${open}${entries.join(", ")}${close}`;
  return `${open}\n${entries.map((entry) => `${inner}${entry},\n`).join("")}${margin}${close}`;
}

/**
 * Every way to run a study elsewhere.
 *
 * @param {string} kind
 * @returns {Export[]}
 */
export function exportsOf(kind) {
  const local = { name: "run", title: "Command line, local", note: "Without a server: results go to the folder “results”.", text: run };
  return [
    { name: "curl", title: "curl", note: "Sends it to this server. Where it asks for a token, set TRAINBRIDGE_TOKEN.", text: curl },
    { name: "submit", title: "Command line", note: "Sends it to this server and follows it to its end.", text: submit },
    ...(kind === "crossing" ? [local] : []),
    { name: "python", title: "Python", note: "Sends it to this server and waits for it.", text: python },
  ];
}
