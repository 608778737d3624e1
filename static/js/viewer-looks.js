// @ts-check
/** What the 3D view is asked to show, as far as the run can show it. Pure. */

/** @typedef {import("./view-address.js").Look} Look */
/** @typedef {import("./types.js").ViewerState} ViewerState */
/** @typedef {import("./viewer-session.js").Steering} Steering */

/**
 * One thing that a run cannot show would have the server refuse all of it.
 *
 * @param {Readonly<Look>} look
 * @param {number | null} proposed scale that suits the run; null leaves the viewer its own
 * @param {ViewerState | null | undefined} state what is shown now, as soon as the server has said so
 * @returns {Steering}
 */
export function looksOf({ colour, scale, camera, hidden, mode, place }, proposed, state) {
  const size = scale ?? proposed;
  return {
    ...(size !== null && { scale: size }),
    ...(state?.available_colours.includes(colour) && { colour }),
    ...(state && camera && camera !== state.camera && { camera }),
    ...(state?.modal && { mode: mode - 1 }),
    ...(state && !state.modal && { place }),
    ...(state && { layers: state.available_layers.filter((name) => !hidden.includes(name)) }),
  };
}
