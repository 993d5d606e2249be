// A headset's hand: a pinch, or a controller's trigger, grasps. Samples are taken in the session's own frames, before
// anything is drawn.
import { clock } from "./tracker_socket.js";
import { XrRig } from "./xr_rig.js";

const PINCH_START = 0.02; // [m] between the tips of thumb and index finger
const PINCH_END = 0.035; // [m] at which a pinch ends: between the two it stays as it is
const SESSION_FEATURES = { requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking"] };

// Why a headset cannot be used, or "" when it can.
export async function xrUnavailableReason() {
  if (!isSecureContext) return "A headset needs a secure page: open this one at localhost, or behind https.";
  if (!navigator.xr)
    return "This browser has no WebXR. Open the page in the headset's own browser, or in Chrome with a headset connected.";
  const able = await navigator.xr.isSessionSupported("immersive-vr").catch(() => false);
  return able ? "" : "No headset is connected. Connect one, or open this page in the headset's own browser.";
}

export class XrHand {
  closed = false;
  frames = 0;
  samples = 0;

  // `onSample({position, orientation, tracked, grasp, clutch, ms, seconds})` is called once a frame with the hand in robot
  // coordinates; `clutch`: the other hand is closed. `onEnd()`: the session is over, whoever ended it. `handedness`: the
  // hand that counts; "": whichever closes.
  constructor(viewer, { onSample, onEnd, onError, handedness = "" }) {
    Object.assign(this, { viewer, onSample, onEnd, onError, handedness });
  }

  // Must be called from a click.
  async start() {
    const session = await navigator.xr.requestSession("immersive-vr", SESSION_FEATURES);
    this.session = session;
    session.addEventListener("end", () => this.#onSessionEnd());
    try {
      this.rig = new XrRig(this.viewer);
      await this.rig.present(session, (time, frame) => this.#frame(time, frame));
    } catch (error) {
      await session.end();
      throw error;
    }
  }

  async end() {
    await this.session?.end().catch(() => {}); // it may have ended already
  }

  #frame(time, frame) {
    this.frames += 1;
    const seconds = this.before ? (time - this.before) / 1000 : 0;
    this.before = time;
    try {
      const hand = this.#read(frame);
      // The frame's time is that of the pose; a runtime that gives none, or another clock's, is not believed.
      const ms = Math.abs(performance.now() - time) < 1000 ? performance.timeOrigin + time : clock();
      this.samples += 1;
      this.onSample({ ...hand, ms, seconds });
    } catch (error) {
      this.onError(`The headset's hand cannot be read: ${error.message}`);
    }
  }

  // The hand that pinches, else the right one, else any; where it is lost it stays where it was, untracked.
  #read(frame) {
    const space = this.rig.space;
    const hands = [...this.session.inputSources].map((source) => this.#pose(frame, source, space)).filter(Boolean);
    const chosen = this.handedness ? hands.find((hand) => hand.side === this.handedness) : this.#choose(hands);
    if (!chosen)
      return {
        ...(this.last ?? { position: [0, 0, 1], orientation: null }),
        tracked: false,
        grasp: this.closed,
        clutch: false,
      };
    this.closed = chosen.grasp;
    this.side = this.closed ? chosen.side : "";
    const placed = this.rig.toRobot(chosen.position, chosen.orientation);
    this.last = placed;
    return {
      ...placed,
      tracked: chosen.tracked,
      grasp: this.closed,
      clutch: hands.some((hand) => hand !== chosen && hand.grasp),
    };
  }

  #choose(hands) {
    return (
      hands.find((hand) => hand.side === this.side) ??
      hands.find((hand) => hand.grasp) ??
      hands.find((hand) => hand.side === "right") ??
      hands[0]
    );
  }

  #pose(frame, source, space) {
    if (source.hand) {
      const [wrist, thumb, index] = ["wrist", "thumb-tip", "index-finger-tip"].map(
        (joint) => source.hand.get(joint) && frame.getJointPose(source.hand.get(joint), space),
      );
      if (!wrist || !thumb || !index) return null;
      const [a, b] = [thumb.transform.position, index.transform.position];
      const gap = Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z);
      const held = this.closed && this.side === source.handedness;
      return {
        side: source.handedness,
        grasp: gap < (held ? PINCH_END : PINCH_START),
        position: [(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2],
        orientation: wrist.transform.orientation,
        tracked: true,
      };
    }
    const pose = source.gripSpace && frame.getPose(source.gripSpace, space);
    if (!pose) return null;
    const { x, y, z } = pose.transform.position;
    const grasp = Boolean(source.gamepad?.buttons[0]?.pressed || source.gamepad?.buttons[1]?.pressed);
    return {
      side: source.handedness,
      grasp,
      position: [x, y, z],
      orientation: pose.transform.orientation,
      tracked: true,
    };
  }

  #onSessionEnd() {
    this.rig?.dispose();
    this.onEnd();
  }
}
