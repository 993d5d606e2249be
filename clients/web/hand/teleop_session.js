// Leading the arm: while the clutch is held, the arm follows this page's hand, or that of a tracker; letting go holds it.
//
// The page is a tracker all the while, and its samples say whether the clutch is held: a page that breaks off, is hidden
// or stands still lets go by itself.
import { linkFrames } from "../arm/kinematics.js";
import { Carry } from "./hand_model.js";
import { Courier } from "./sample_sender.js";
import { name } from "./tracker_name.js";
import { pointer } from "./pointer_drag.js";
import { Prop } from "./carried_object.js";
import { Sampler } from "./fixed_rate_timer.js";
import { steering } from "./keyboard_gamepad.js";

const BALL = { kind: "sphere", size: [0.028] }; // [m] what is dragged; it waits at the gripper

export class Leading {
  pressed = false; // the clutch
  placed = false; // it is known where the gripper is
  closed = false; // the hand; the gripper closes and opens with it while the clutch is held
  gripped = false; // the gripper, as the arm says
  #ends = [];

  // `arm` as GET /robot gives it; `scene` around it. `own`: the page's hand leads, else a tracker's does; `worn`: it is that
  // of a headset, and hear() is told its frames. `button` is the clutch. `changed()` is called when the clutch or the connection changes, `failed(sentence)` ends the sitting.
  constructor(easel, scene, arm, { own, worn, button, changed, failed }) {
    Object.assign(this, { easel, arm, own, worn, button, changed, failed, name: `${name}-lead` });
    this.carry = new Carry({ ...scene, carried: { ...BALL, position: [0, 0, 0] } });
    this.link = new Courier(this.name, { changed: (state, sentence) => this.#connection(state, sentence), refused: () => {} });
    this.sampler = new Sampler((seconds) => this.#tick(seconds));
  }

  // Connect, and wait for the clutch.
  async begin() {
    await this.link.connect();
    if (this.worn) return;
    const deeds = { may: () => this.placed && this.link.live, grasp: () => this.#press(true), release: () => this.#press(false) };
    this.steering = steering(this.easel, this.carry, deeds, { held: true, places: [this.button] });
    this.#ends.push(() => this.steering.end(), this.#held(deeds));
    if (this.own) this.#ends.push(pointer(this.easel, this.carry, deeds), () => this.prop?.remove());
    const hidden = () => document.hidden && this.#press(false);
    document.addEventListener("visibilitychange", hidden);
    this.#ends.push(() => document.removeEventListener("visibilitychange", hidden));
    this.sampler.start();
  }

  // Where the arm is now, at configuration `q` [rad], and its gripper: the hand waits there, and is as that is.
  follow(q, gripped) {
    const same = gripped === this.gripped;
    this.gripped = gripped;
    if (this.pressed) return;
    this.closed = gripped;
    if (!same) this.changed();
    const tool = linkFrames(this.arm.links, q).at(-1);
    this.carry.position = [12, 13, 14].map((i) => tool[i] + this.arm.tool_length * tool[i - 4]);
    this.carry.target = [...this.carry.position];
    this.placed = true;
    if (this.own && !this.worn) this.prop ??= new Prop(this.easel, BALL);
    this.#draw();
  }

  // A headset's frame: one hand leads, the other one's pinch or trigger is the clutch.
  hear(sample) {
    this.#press(sample.clutch);
    this.closed = sample.grasp;
    this.link.send({ ...sample, clutch: this.pressed });
  }

  // Close the gripper, or open it; the arm takes it from a hand that it follows.
  grip() {
    if (!this.pressed) return;
    this.closed = !this.closed;
    this.changed();
  }

  end() {
    this.#press(false);
    this.sampler.stop();
    for (const end of this.#ends.splice(0)) end();
    this.link.close();
  }

  #held({ grasp, release }) {
    const down = (event) => {
      this.button.setPointerCapture(event.pointerId);
      grasp();
    };
    const key = (event) => event.key.toLowerCase() === "g" && !event.repeat && this.grip();
    const heard = [["pointerdown", down], ["pointerup", release], ["pointercancel", release], ["lostpointercapture", release], ["keydown", key]];
    for (const [name, hear] of heard) this.button.addEventListener(name, hear);
    this.easel.element.addEventListener("keydown", key);
    return () => {
      for (const [name, hear] of heard) this.button.removeEventListener(name, hear);
      this.easel.element.removeEventListener("keydown", key);
    };
  }

  #press(pressed) {
    if (pressed === this.pressed || (pressed && !(this.placed && this.link.live))) return;
    this.pressed = this.carry.grasped = pressed;
    this.carry.target = [...this.carry.position];
    if (!this.worn) this.#send();
    this.#draw();
    this.changed();
  }

  #tick(seconds) {
    this.steering.step(seconds);
    if (this.pressed && this.carry.step(seconds)) this.#draw();
    this.#send();
  }

  #send() {
    const { carry, closed, pressed } = this;
    this.link.pose({ position: carry.position, orientation: null, tracked: true, grasp: closed, clutch: pressed });
  }

  #connection(state, sentence) {
    if (state === "refused") this.failed(sentence);
    if (state === "lost") this.#press(false);
    this.changed();
  }

  #draw() {
    this.prop?.place(this.carry.position, this.carry.below(this.carry.position), { grasped: this.pressed, wrong: false });
  }
}
