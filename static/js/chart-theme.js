// @ts-check
/** A figure from the server in the page's colours. Pure: the server's dictionary stays as it is. */

/** @typedef {import("./types.js").Figure} Figure */
/** @typedef {{ dark: boolean, ink: string, soft: string, line: string, paper: string, type: string }} Theme */

/** Height of the legend over a callout, as a part of the axes' height; over one line, or in a tall chart. */
const ABOVE_CALLOUT = 1.24;
const ABOVE_WORD = 1.1;
/** Up to this part of the axis' height a callout stands below the legend anyway. */
const LOW_ENOUGH = 0.7;

/** On a dark ground the deep tones of the palette turn into their light neighbours. */
const DARK = new Map([
  ["#0072B2", "#58B5F0"],
  ["#8FC1DE", "#2F6486"],
  ["#D55E00", "#FF9A52"],
  ["#009E73", "#3CCFA2"],
  ["#86CBB7", "#24715B"],
  ["#F2D08A", "#7A6328"],
  ["#E3BCD2", "#7C5168"],
  ["#B5DCF3", "#3B6580"],
  ["#7A8794", "#98A7B4"],
  ["#22303C", "#E9EFF4"],
]);

/**
 * Data and layout for plotly.js.
 *
 * @param {Figure} figure
 * @param {Theme} theme
 * @param {boolean} narrow
 */
export function themed(figure, theme, narrow) {
  const source = theme.dark ? recolored(figure) : figure;
  const axis = {
    gridcolor: theme.line,
    linecolor: theme.line,
    zerolinecolor: theme.line,
    tickcolor: theme.line,
    ticks: "outside",
    fixedrange: false,
  };
  const { title: _, ...layout } = source.layout;
  const upwards = layout.annotations.some((/** @type {any} */ note) => note.showarrow && note.ay < 0 && isHigh(note.y, layout.yaxis?.range));
  return {
    data: narrow ? source.data.map(shortened) : source.data,
    layout: {
      ...layout,
      uirevision: "kept",
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: theme.type, color: theme.soft, size: 12 },
      margin: narrow ? { l: 46, r: 10, t: 8, b: 40 } : { l: 62, r: 18, t: 8, b: 42 },
      // A callout above its peak stands between the curves and the legend.
      legend: { orientation: "h", x: 0, y: upwards ? (narrow || layout.yaxis2 ? ABOVE_WORD : ABOVE_CALLOUT) : 1.02, yanchor: "bottom", font: { size: 12 } },
      hoverlabel: { bgcolor: theme.paper, bordercolor: theme.line, font: { color: theme.ink } },
      ...axes(layout, axis),
      annotations: layout.annotations.map((/** @type {any} */ note) => placed(note, theme, narrow)),
    },
  };
}

/**
 * Whether words above a value reach beyond the axes.
 *
 * @param {number} value
 * @param {number[] | undefined} range of its axis; unknown where plotly.js chooses it
 */
function isHigh(value, range) {
  return !range || (value - range[0]) / (range[1] - range[0]) > LOW_ENOUGH;
}

/**
 * Every axis of a figure, drawn alike; tiny values get a power of ten that fits the margin.
 *
 * @param {any} layout
 * @param {Record<string, unknown>} look
 */
function axes(layout, look) {
  const names = ["xaxis", "yaxis", ...Object.keys(layout).filter((key) => /^[xy]axis\d+$/.test(key))];
  return Object.fromEntries(
    names.map((name) => [name, name.startsWith("x") ? { ...look, ...layout[name] } : { ...look, automargin: true, ...layout[name], exponentformat: "power" }]),
  );
}

/**
 * A curve whose name fits a narrow legend: where it lies stands in the words below.
 *
 * @param {any} curve
 */
function shortened(curve) {
  return { ...curve, name: String(curve.name).replace(/, x = [^,]+, y = [^,]+/, "") };
}

/**
 * Words on the page's paper; a narrow chart has room for a callout's value, not for its place, and
 * for the name of a part, not for a remark on it.
 *
 * @param {any} note
 * @param {Theme} theme
 * @param {boolean} narrow
 */
function placed(note, theme, narrow) {
  const colored = note.bgcolor ? { ...note, bgcolor: theme.paper, borderpad: 3 } : note;
  if (!narrow) return colored;
  if (!note.showarrow) return { ...colored, text: note.text.split(": ")[0] };
  return { ...colored, text: note.text.split("<br>")[0], ax: note.ax / 2 };
}

/**
 * @param {any} value
 * @returns {any}
 */
function recolored(value) {
  if (typeof value === "string") return DARK.get(value) ?? value;
  if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map(recolored);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, recolored(part)]));
}
