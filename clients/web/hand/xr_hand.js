// A headset's hand: a pinch, or a controller's trigger, grasps. Samples are taken in the session's own frames, before
// anything is drawn.
import { clock } from "./tracker_socket.js";
import { XrRig } from "./xr_rig.js";

const PINCH_START = 0.02; // [m] between the tips of thumb and index finger
const PINCH_END = 0.035; // [m] at which a pinch ends: between the two it stays as it is
const SESSION_FEATURES = { requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking"] };

// Why a headset cannot be used, or "" when it can.
export async function xrUnavailableReason() {
  if (!isSecureContext)
    return "A headset needs a secure page: open this one at localhost, or by https (teachpath tls init).";
  if (!navigator.xr)
    return "This browser has no WebXR. Open the page in the headset's own browser, or in Chrome with a headset connected.";
  const able = await navigator.xr.isSessionSupported("immersive-vr").catch(() => false);
  return able ? "" : "No headset is connected. Connect one, or open this page in the headset's own browser.";
}

/** @typedef {{side: XRHandedness, grasp: boolean, position: Point, orientation: DOMPointReadOnly}} TrackedHand */

/**
 * @typedef {object} XrHandOptions
 * @property {(sample: Required<HandSample>) => void} onSample called once a frame with the hand in robot coordinates; its
 *   `clutch`: the other hand is closed
 * @property {() => void} onEnd the session is over, whoever ended it
 * @property {(sentence: string) => void} onError
 * @property {XRHandedness | ""} [handedness] the hand that counts; "": whichever closes
 */

export class XrHand {
  closed = false;
  frames = 0;
  samples = 0;
  /** @type {XRSession | null} */
  #session = null;
  #before = 0; // [ms] of the frame before
  #side = ""; // of the hand that is closed
  /** @type {{position: Point, orientation: number[] | null}} */
  #last = { position: [0, 0, 1], orientation: null };

  /** @param {MeshCatViewer} viewer @param {XrHandOptions} options */
  constructor(viewer, { onSample, onEnd, onError, handedness = "" }) {
    this.onSample = onSample;
    this.onEnd = onEnd;
    this.onError = onError;
    this.handedness = handedness;
    this.rig = new XrRig(viewer);
  }

  /** Must be called from a click. */
  async start() {
    try {
      this.#session = (await navigator.xr?.requestSession("immersive-vr", SESSION_FEATURES)) ?? null;
    } catch (error) {
      this.rig.dispose();
      throw error;
    }
    if (this.#session) await this.#present(this.#session);
  }

  async end() {
    await this.#session?.end().catch(() => {}); // it may have ended already
  }

  /** @param {XRSession} session */
  async #present(session) {
    session.addEventListener("end", () => this.#onSessionEnd());
    try {
      await this.rig.present(session, (time, frame, space) => this.#frame(session, time, frame, space));
    } catch (error) {
      await session.end();
      throw error;
    }
  }

  /** @param {XRSession} session @param {number} time @param {XRFrame} frame @param {XRReferenceSpace} space */
  #frame(session, time, frame, space) {
    this.frames += 1;
    const seconds = this.#before ? (time - this.#before) / 1000 : 0;
    this.#before = time;
    try {
      const hand = this.#read(session, frame, space);
      // The frame's time is that of the pose; a runtime that gives none, or another clock's, is not believed.
      const ms = Math.abs(performance.now() - time) < 1000 ? performance.timeOrigin + time : clock();
      this.samples += 1;
      this.onSample({ ...hand, ms, seconds });
    } catch (error) {
      this.onError(`The headset's hand cannot be read: ${error instanceof Error ? error.message : error}`);
    }
  }

  /**
   * The hand that pinches, else the right one, else any; where it is lost it stays where it was, untracked.
   * @param {XRSession} session
   * @param {XRFrame} frame
   * @param {XRReferenceSpace} space
   */
  #read(session, frame, space) {
    const hands = [...session.inputSources].flatMap((source) => this.#track(frame, source, space) ?? []);
    const chosen = this.#choose(hands);
    if (!chosen) return { ...this.#last, tracked: false, grasp: this.closed, clutch: false };
    this.closed = chosen.grasp;
    this.#side = this.closed ? chosen.side : "";
    this.#last = this.rig.toRobot(chosen.position, chosen.orientation);
    const clutch = hands.some((hand) => hand !== chosen && hand.grasp);
    return { ...this.#last, tracked: true, grasp: this.closed, clutch };
  }

  /** @param {TrackedHand[]} hands */
  #choose(hands) {
    /** @param {string} side */
    const at = (side) => hands.find((hand) => hand.side === side);
    if (this.handedness) return at(this.handedness);
    return at(this.#side) ?? hands.find((hand) => hand.grasp) ?? at("right") ?? hands[0];
  }

  /**
   * @param {XRFrame} frame
   * @param {XRInputSource} source
   * @param {XRReferenceSpace} space
   * @returns {TrackedHand | null}
   */
  #track(frame, source, space) {
    if (source.hand) return this.#trackFingers(frame, source.hand, source.handedness, space);
    const pose = source.gripSpace && frame.getPose(source.gripSpace, space);
    if (!pose) return null;
    const { x, y, z } = pose.transform.position;
    const grasp = Boolean(source.gamepad?.buttons[0]?.pressed || source.gamepad?.buttons[1]?.pressed);
    return { side: source.handedness, grasp, position: [x, y, z], orientation: pose.transform.orientation };
  }

  /**
   * @param {XRFrame} frame
   * @param {XRHand} hand
   * @param {XRHandedness} side
   * @param {XRReferenceSpace} space
   * @returns {TrackedHand | null}
   */
  #trackFingers(frame, hand, side, space) {
    /** @param {XRHandJoint} name */
    const pose = (name) => {
      const joint = hand.get(name);
      return joint && frame.getJointPose?.(joint, space);
    };
    const [wrist, thumb, index] = [pose("wrist"), pose("thumb-tip"), pose("index-finger-tip")];
    if (!wrist || !thumb || !index) return null;
    const [a, b] = [thumb.transform.position, index.transform.position];
    const gap = Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z);
    const held = this.closed && this.#side === side;
    return {
      side,
      grasp: gap < (held ? PINCH_END : PINCH_START),
      position: [(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2],
      orientation: wrist.transform.orientation,
    };
  }

  #onSessionEnd() {
    this.rig.dispose();
    this.onEnd();
  }
}
