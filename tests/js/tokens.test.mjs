// Contrast of the page's colours, computed from css/tokens.css (WCAG 2.2, 1.4.3 and 1.4.11).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

const text = readFileSync(new URL("../../static/css/tokens.css", import.meta.url), "utf8").replace(/\/\*[^]*?\*\//g, "");
const [light, dark] = [...text.matchAll(/:root[^{]*\{([^}]*)\}/g)].map(([, body]) =>
  Object.fromEntries([...body.matchAll(/--([\w-]+):\s*(#[0-9a-f]{6})\b/g)].map(([, name, colour]) => [name, colour])),
);
const themes = { light, dark: { ...light, ...dark } };

const SURFACES = ["paper", "card", "sunken"];
const TEXTS = ["ink", "ink-soft", "ink-faint", "accent", "good", "bad", "wait"];
const SERIES = [1, 2, 3, 4, 5, 6, 7].map((number) => `series-${number}`);

/** Relative luminance of sRGB, WCAG 2.2. @param {string} colour */
function luminance(colour) {
  const [red, green, blue] = [1, 3, 5].map((at) => {
    const part = parseInt(colour.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** @param {string} one @param {string} other */
function contrast(one, other) {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}

/** Every pair at once, so that one run tells all that is wrong. */
function tooFaint(theme, pairs, least) {
  return pairs
    .map(([ink, ground]) => [`${ink} on ${ground}`, contrast(theme[ink], theme[ground])])
    .filter(([, value]) => value < least)
    .map(([pair, value]) => `${pair}: ${value.toFixed(2)}`);
}

for (const [name, theme] of Object.entries(themes)) {
  test(`${name}: every text colour can be read on every surface`, () => {
    const pairs = TEXTS.flatMap((ink) => SURFACES.map((ground) => [ink, ground]));
    const own = ["good", "bad", "wait", "accent"].map((role) => [role, `${role}-soft`]);
    const soft = ["accent-soft", "good-soft", "bad-soft", "wait-soft"].flatMap((ground) => [["ink", ground], ["ink-soft", ground]]);
    assert.deepEqual(tooFaint(theme, [...pairs, ...own, ...soft, ["accent-ink", "accent"]], 4.5), []);
  });

  test(`${name}: edges of controls and the curves of charts stand out from their ground`, () => {
    const marks = ["line-strong", "accent", ...SERIES];
    const pairs = marks.flatMap((mark) => ["card", "paper"].map((ground) => [mark, ground]));
    // Okabe and Ito's light tones are read by their dash pattern and their name as well.
    const pale = name === "light" ? /^series-[456] / : /^$/;
    assert.deepEqual(tooFaint(theme, pairs, 3).filter((pair) => !pale.test(pair)), []);
  });
}

test("the dark theme gives every colour anew", () => {
  assert.deepEqual(Object.keys(light).sort(), Object.keys(dark).sort());
});
