// @ts-check
/** What the 3D view is asked to show, as far as the run can show it. Pure. */
import { poseText } from "./view-address.js";

/** @typedef {import("./view-address.js").Look} Look */
/** @typedef {import("./types.js").ViewerState} ViewerState */
/** @typedef {import("./viewer-session.js").Steering} Steering */

/**
 * One thing that a run cannot show would have the server refuse all of it.
 *
 * @param {Readonly<Look>} look
 * @param {number | null} proposed scale that suits the run; null leaves the viewer its own
 * @param {ViewerState | null | undefined} state what is shown now, as soon as the server has said so
 * @param {boolean} [aims] whether somebody asks for the camera's place: the viewer's own word of it is
 *   never sent back
 * @returns {Steering}
 */
export function looksOf({ colour, scale, camera, pose, time, hidden, mode, place }, proposed, state, aims = false) {
  const size = scale ?? proposed;
  return {
    ...(size !== null && { scale: size }),
    ...(state?.available_colours.includes(colour) && { colour }),
    ...(state && camera && camera !== state.camera && { camera }),
    ...(state && aims && { pose: pose && { ...pose, ...(time !== null && { time }) } }),
    ...(state?.modal && { mode: mode - 1 }),
    ...(state && !state.modal && { place }),
    ...(state && { layers: state.available_layers.filter((name) => !hidden.includes(name)) }),
  };
}

/**
 * Where somebody has moved the camera, as an address should say it; null where it says so already.
 *
 * @param {Readonly<Look>} look
 * @param {ViewerState} state
 * @returns {Partial<Look> | null}
 */
export function poseNews(look, state) {
  const pose = steadyPose(state);
  if (pose === undefined || JSON.stringify(pose) === JSON.stringify(look.pose)) return null;
  // One that follows the train is there at that time only.
  return { pose, ...(pose && state.camera === "follow" && !state.modal && { time: state.time }) };
}

/**
 * Where somebody has moved the camera; undefined where it rides along with the train just now.
 *
 * @param {Pick<ViewerState, "pose" | "camera" | "playing" | "modal">} state
 */
export function steadyPose({ pose, camera, playing, modal }) {
  return camera === "follow" && playing && !modal ? undefined : (pose ?? null);
}

/** What the menu of cameras says: a camera that was moved is nobody's preset, unless it rides along. @param {Pick<ViewerState, "pose" | "camera">} state */
export const cameraShown = ({ pose, camera }) => (pose && camera !== "follow" ? "free" : camera);

/**
 * Where a picture is taken from, as its address says it.
 *
 * @param {Pick<Look, "camera" | "pose" | "time">} look
 * @param {number} now time of the picture [s]
 * @returns {Record<string, string>}
 */
export function cameraAsked({ camera, pose, time }, now) {
  const there = camera !== "follow" || time === null || Math.abs(now - time) < 1e-3;
  return { ...(camera && camera !== "free" && { camera }), ...(pose && there && { pose: poseText(pose) }) };
}
