// Teleoperation: while the clutch is held, the arm follows this page's hand, or that of a tracker; letting go holds the arm.
//
// The page is a tracker during the session, and its samples say whether the clutch is held: a page that is closed, hidden
// or stalled releases the clutch by itself.
import { toolPose } from "../arm/kinematics.js";
import { CarriedObject } from "./carried_object.js";
import { FixedRateTimer } from "./fixed_rate_timer.js";
import { HandModel } from "./hand_model.js";
import { attachKeyboardGamepad } from "./keyboard_gamepad.js";
import { attachPointerDrag } from "./pointer_drag.js";
import { SampleSender } from "./sample_sender.js";
import { TRACKER_NAME } from "./tracker_name.js";

const HANDLE = { kind: "sphere", size: [0.028] }; // [m] what is dragged; it stands at the gripper

/**
 * @typedef {object} TeleopOptions
 * @property {boolean} usesPageHand the page's hand leads, else a tracker's does
 * @property {boolean} usesHeadset the page's hand is that of a headset, whose samples go to addHeadsetSample()
 * @property {HTMLElement} button the clutch
 * @property {() => void} onChange the clutch or the connection has changed
 * @property {(sentence: string) => void} onError the session cannot go on
 */

export class TeleopSession {
  clutchPressed = false;
  isPositioned = false; // the hand stands at the gripper, whose place is known
  handClosed = false; // the gripper closes and opens with the hand while the clutch is held
  gripperClosed = false; // as the arm reports it
  /** @type {(() => void)[]} */
  #disposers = [];
  /** @type {CarriedObject | null} */
  #handle = null;
  /** @type {ReturnType<typeof attachKeyboardGamepad> | null} */
  #keyboardGamepad = null;

  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {Scene} scene around the arm
   * @param {Robot} arm
   * @param {TeleopOptions} options
   */
  constructor(overlay, scene, arm, { usesPageHand, usesHeadset, button, onChange, onError }) {
    this.overlay = overlay;
    this.arm = arm;
    this.usesPageHand = usesPageHand;
    this.usesHeadset = usesHeadset;
    this.button = button;
    this.onChange = onChange;
    this.onError = onError;
    this.name = `${TRACKER_NAME}-lead`;
    this.handModel = new HandModel({ ...scene, carried: { ...HANDLE, position: [0, 0, 0] } });
    this.sender = new SampleSender(this.name, {
      onChange: (state, sentence) => this.#onConnection(state, sentence),
      onRejected: () => {},
    });
    this.timer = new FixedRateTimer((seconds) => this.#tick(seconds));
  }

  /** Connect, and wait for the clutch. */
  async begin() {
    await this.sender.connect();
    if (this.usesHeadset) return;
    const actions = {
      canGrasp: () => this.isPositioned && this.sender.live,
      grasp: () => this.#setClutch(true),
      release: () => this.#setClutch(false),
    };
    this.#keyboardGamepad = attachKeyboardGamepad(this.overlay, this.handModel, actions, {
      held: true,
      places: [this.button],
    });
    this.#disposers.push(() => this.#keyboardGamepad?.end(), this.#bindClutch());
    if (this.usesPageHand)
      this.#disposers.push(attachPointerDrag(this.overlay, this.handModel, actions), () => this.#handle?.remove());
    const hidden = () => document.hidden && this.#setClutch(false);
    document.addEventListener("visibilitychange", hidden);
    this.#disposers.push(() => document.removeEventListener("visibilitychange", hidden));
    this.timer.start();
  }

  /**
   * Tell where the arm is now, and its gripper: without the clutch, the hand follows both.
   * @param {number[]} q configuration [rad]
   * @param {boolean} gripperClosed
   */
  setArmState(q, gripperClosed) {
    const same = gripperClosed === this.gripperClosed;
    this.gripperClosed = gripperClosed;
    if (this.clutchPressed) return;
    this.handClosed = gripperClosed;
    if (!same) this.onChange();
    this.handModel.position = toolPose(this.arm, q).slice(12, 15);
    this.handModel.target = [...this.handModel.position];
    this.isPositioned = true;
    if (this.usesPageHand && !this.usesHeadset) this.#handle ??= new CarriedObject(this.overlay, HANDLE);
    this.#draw();
  }

  /**
   * Take a headset's sample: one hand leads, the other one's pinch or trigger is the clutch.
   * @param {HandSample & {clutch: boolean}} sample
   */
  addHeadsetSample(sample) {
    this.#setClutch(sample.clutch);
    this.handClosed = sample.grasp;
    this.sender.send({ ...sample, clutch: this.clutchPressed });
  }

  /** Close the gripper, or open it; the arm takes this from the hand, and only while it follows. */
  toggleGripper() {
    if (!this.clutchPressed) return;
    this.handClosed = !this.handClosed;
    this.onChange();
  }

  end() {
    this.#setClutch(false);
    this.timer.stop();
    for (const end of this.#disposers.splice(0)) end();
    this.sender.close();
  }

  /** The button is the clutch while it is pressed; G closes and opens the gripper. Returns what detaches the listeners. */
  #bindClutch() {
    const listening = new AbortController();
    const { signal } = listening;
    const { button } = this;
    const release = () => this.#setClutch(false);
    /** @param {PointerEvent} event */
    const press = (event) => {
      button.setPointerCapture(event.pointerId);
      this.#setClutch(true);
    };
    /** @param {KeyboardEvent} event */
    const toggle = (event) => {
      if (event.key.toLowerCase() === "g" && !event.repeat) this.toggleGripper();
    };
    button.addEventListener("pointerdown", press, { signal });
    button.addEventListener("pointerup", release, { signal });
    button.addEventListener("pointercancel", release, { signal });
    button.addEventListener("lostpointercapture", release, { signal });
    for (const place of [button, this.overlay.element]) place.addEventListener("keydown", toggle, { signal });
    return () => listening.abort();
  }

  /** @param {boolean} pressed */
  #setClutch(pressed) {
    if (pressed === this.clutchPressed || (pressed && !(this.isPositioned && this.sender.live))) return;
    this.clutchPressed = this.handModel.grasped = pressed;
    this.handModel.target = [...this.handModel.position];
    if (!this.usesHeadset) this.#send();
    this.#draw();
    this.onChange();
  }

  /** @param {number} seconds */
  #tick(seconds) {
    this.#keyboardGamepad?.step(seconds);
    if (this.clutchPressed && this.handModel.step(seconds)) this.#draw();
    this.#send();
  }

  #send() {
    const { handModel, handClosed, clutchPressed } = this;
    this.sender.setPose({
      position: handModel.position,
      orientation: null,
      tracked: true,
      grasp: handClosed,
      clutch: clutchPressed,
    });
  }

  /** @param {string} state @param {string} sentence */
  #onConnection(state, sentence) {
    if (state === "refused") this.onError(sentence);
    if (state === "lost") this.#setClutch(false);
    this.onChange();
  }

  #draw() {
    this.#handle?.setPosition(this.handModel.position, this.handModel.heightBelow(this.handModel.position), {
      grasped: this.clutchPressed,
      colliding: false,
    });
  }
}
