// The camera's place: in the address both ways, asked of the viewer once, never echoed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { addressOf, lookOf } from "../../static/js/view-address.js";
import { cameraAsked, cameraShown, looksOf, poseNews, steadyPose } from "../../static/js/viewer-looks.js";
import { ViewerPose } from "../../static/js/viewer-pose.js";
import { ViewerSession } from "../../static/js/viewer-session.js";

const look = (text = "") => lookOf(new URLSearchParams(text));
const POSE = { position: [-21.5, -40.125, 12], look_at: [27, 0, 1.335], fov: null };
const TEXT = "-21.5,-40.125,12,27,0,1.335";
const STATE = { available_colours: ["none"], available_layers: [], camera: "side", modal: false, playing: false, time: 2, pose: null };

test("an address holds a pose in whole millimetres, and gives it back", () => {
  assert.deepEqual(addressOf({ pose: POSE }), { pose: TEXT });
  assert.deepEqual(look(`pose=${TEXT}`).pose, POSE);
  const fine = { position: [1.00049, -0.0004, 1 / 3], look_at: [0, 0, 0], fov: 0.174533 };
  assert.deepEqual(addressOf({ pose: fine }), { pose: "1,0,0.333,0,0,0,0.1745" });
  assert.deepEqual(look("pose=1,0,0.333,0,0,0,0.1745").pose?.fov, 0.1745);
  assert.deepEqual(addressOf({ pose: null }), { pose: null });
  assert.deepEqual(addressOf({ camera: "side" }), { camera: "side" });
});

test("a pose that cannot be is left out: the server would refuse all that comes with it", () => {
  const odd = ["", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,x", "1,2,3,4,5,", "1,2,3,1,2,3", "1,2,3,1,2,3.009", "1e6,0,0,1,1,1", "NaN,0,0,1,1,1"];
  const wide = ["1,2,3,4,5,6,0", "1,2,3,4,5,6,9", "1,2,3,4,5,6,x", "1,2,3,4,5,6,0.5,7"];
  for (const text of [...odd, ...wide]) assert.equal(look(`pose=${text}`).pose, null, text);
});

test("the viewer is told a pose where somebody asks for it, with its time, and not else", () => {
  const asked = look(`pose=${TEXT}&camera=follow&t=2.6`);
  assert.deepEqual(looksOf(asked, null, STATE, true).pose, { ...POSE, time: 2.6 });
  assert.deepEqual(looksOf(look(`pose=${TEXT}`), null, STATE, true).pose, POSE);
  assert.ok(!("pose" in looksOf(asked, null, STATE)));
  assert.ok(!("pose" in looksOf(asked, null, null, true)), "nothing is known of the run yet");
  // The same preset again: the camera goes back to it.
  assert.deepEqual(looksOf(look("camera=side"), null, STATE, true), { pose: null, place: null, layers: [] });
});

test("what the viewer says is written once it is at rest", () => {
  const moved = { ...STATE, pose: POSE };
  assert.deepEqual(poseNews(look(), moved), { pose: POSE });
  assert.equal(poseNews(look(`pose=${TEXT}`), moved), null);
  assert.deepEqual(poseNews(look(`pose=${TEXT}`), STATE), { pose: null });
  // Beside the train it is there at one time only.
  const follows = { ...moved, camera: "follow" };
  assert.deepEqual(poseNews(look(), follows), { pose: POSE, time: 2 });
  assert.equal(poseNews(look(), { ...follows, playing: true }), null);
  assert.deepEqual(poseNews(look(), { ...follows, playing: true, modal: true }), { pose: POSE });
  assert.equal(steadyPose({ ...follows, playing: true }), undefined);
  assert.equal(poseNews(look(), { ...STATE, pose: undefined }), null);
});

test("the menu says free of a camera that was moved, unless it follows", () => {
  assert.deepEqual([STATE, { ...STATE, pose: POSE }, { pose: POSE, camera: "follow" }].map(cameraShown), ["side", "free", "follow"]);
});

test("a picture is taken from the pose; beside the train at its time only", () => {
  assert.deepEqual(cameraAsked(look(`camera=side&pose=${TEXT}&t=1`), 3), { camera: "side", pose: TEXT });
  assert.deepEqual(cameraAsked(look(`camera=follow&pose=${TEXT}&t=1`), 3), { camera: "follow" });
  assert.deepEqual(cameraAsked(look(`camera=follow&pose=${TEXT}&t=1`), 1), { camera: "follow", pose: TEXT });
  assert.deepEqual(cameraAsked(look("camera=free"), 0), {});
});

/** What is looked at, as RunView holds it. */
class View extends EventTarget {
  constructor(text) {
    super();
    this.look = look(text);
    this.written = [];
  }

  set(change) {
    this.look = { ...this.look, ...change };
    this.written.push(change);
    const event = new Event("change");
    this.dispatchEvent(Object.assign(event, { detail: change }));
  }
}

/** A session as the page sees it, whose answers somebody gives. */
class Session extends EventTarget {
  settled = true;
  state = null;

  answer(state) {
    this.state = { ...STATE, ...state };
    this.dispatchEvent(new Event("state"));
  }
}

function opened(text) {
  const [view, session, ended] = [new View(text), new Session(), new AbortController()];
  const pose = new ViewerPose(view, ended.signal);
  pose.begin(session);
  return { view, session, pose, told: () => looksOf(view.look, null, session.state, pose.asks) };
}

test("an address's pose is asked for once, and not taken back by what was said before", () => {
  const { view, session, told } = opened(`pose=${TEXT}`);
  session.settled = false; // the frame steers as soon as it knows what can be shown
  session.answer({});
  assert.deepEqual(told().pose, POSE);
  assert.deepEqual(view.written, []);
  session.settled = true;
  session.answer({ pose: POSE });
  assert.deepEqual(view.written, []);
  assert.ok(!("pose" in told()));
});

test("what a hand does is written and never sent back", () => {
  const { view, session, told } = opened("");
  for (const x of [1, 2, 3]) {
    session.answer({ pose: { ...POSE, position: [x, 0, 0] } });
    assert.ok(!("pose" in told()));
  }
  assert.deepEqual(view.written.map(({ pose }) => pose.position[0]), [1, 2, 3]);
  session.answer({ pose: { ...POSE, position: [3, 0, 0] } });
  assert.equal(view.written.length, 3);
});

test("a preset that is chosen, the same again too, is asked for until it is answered", () => {
  const { view, session, told } = opened("camera=side");
  session.answer({ pose: POSE });
  view.set({ camera: "side", pose: null });
  assert.equal(told().pose, null);
  session.settled = false;
  session.answer({ pose: POSE }); // an answer to what was said before
  assert.equal(view.look.pose, null);
  assert.equal(told().pose, null);
  session.settled = true;
  session.answer({ pose: null });
  assert.ok(!("pose" in told()));
  assert.equal(view.look.pose, null);
});

test("a session that opens anew is told the pose of the one before", () => {
  const { view, session, pose, told } = opened("");
  session.answer({ pose: POSE });
  const next = new Session();
  pose.begin(next);
  session.state = { ...STATE };
  assert.deepEqual(told().pose, POSE);
  assert.deepEqual(view.look.pose, POSE);
});

test("once a hand is off the camera, it is looked at until it stays", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { session, pose, view } = opened("");
  const glides = [1, 2, 2, 2];
  let looks = 0;
  session.look = async () => session.answer({ pose: { ...POSE, position: [glides[looks++], 0, 0] } });
  pose.rest();
  t.mock.timers.tick(200);
  pose.rest(); // the wheel turns on
  t.mock.timers.tick(399);
  assert.equal(looks, 0);
  for (let wait = 0; wait < 6; wait += 1) {
    t.mock.timers.tick(400);
    await new Promise((resolve) => setImmediate(resolve));
  }
  assert.equal(looks, 3);
  assert.deepEqual(view.look.pose?.position, [2, 0, 0]);
});

test("an answer to what was asked before somebody steered is dropped", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout", "setInterval"] });
  /** @type {((body: any) => void)[]} */
  const open = [];
  t.mock.method(globalThis, "fetch", (url, options = {}) => new Promise((resolve) => {
    const answer = (body) => resolve(new Response(JSON.stringify(body), { status: 200, headers: { "content-type": "application/json" } }));
    open.push(Object.assign(answer, { method: options.method ?? "GET" }));
  }));
  globalThis.document ??= /** @type {any} */ ({ hidden: false });
  const turn = async () => {
    for (let step = 0; step < 8; step += 1) await new Promise((resolve) => setImmediate(resolve));
  };
  const session = new ViewerSession();
  const seen = [];
  session.addEventListener("state", () => seen.push([session.state?.time, session.settled]));
  const opening = session.open("run", "light");
  await turn();
  open.shift()?.({ session: "s", url: "/viewer/s/" });
  await opening;
  void session.look();
  await turn();
  session.steer({ camera: "side" });
  await turn();
  open.shift()?.({ ...STATE, time: 1 }); // the look of before
  await turn();
  assert.deepEqual(seen, []);
  void session.look(); // says nothing new: an answer is on its way
  await turn();
  assert.deepEqual(open.map(({ method }) => method), ["PUT"]);
  session.steer({ scale: 5 });
  open.shift()?.({ ...STATE, time: 2 });
  await turn();
  assert.deepEqual(seen, [[2, false]]);
  t.mock.timers.tick(100);
  await turn();
  open.shift()?.({ ...STATE, time: 3 });
  await turn();
  assert.deepEqual(seen, [[2, false], [3, true]]);
});
