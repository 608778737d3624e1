// @ts-check
/** How much a deformation is exaggerated so that it is well seen. Pure. */

/** @typedef {import("./types.js").TableRow} TableRow */

/** Height that the greatest displacement should have in the 3D view. [m] */
const SEEN = 0.6;
/** More than this would show the noise of a bridge at rest. */
const MOST = 500;

/**
 * A round scale for the displacements of a figure.
 *
 * @param {TableRow[]} rows extremes, in mm
 */
export function pleasingScale(rows) {
  const sizes = rows.flatMap((row) => [row.minimum ?? 0, row.maximum ?? 0]).map(Math.abs);
  const peak = Math.max(0, ...sizes) / 1000;
  if (peak * MOST <= SEEN) return MOST;
  const wanted = SEEN / peak;
  const order = 10 ** Math.floor(Math.log10(wanted));
  const digit = [5, 2, 1].find((part) => part * order <= wanted) ?? 1;
  return Math.max(1, digit * order);
}
