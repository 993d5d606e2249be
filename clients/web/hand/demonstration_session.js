// One sitting of "show it here": a recording from the page's own hand, take after take, until it is finished.
//
// phase: "countdown" > "ready" (the object waits at its start) > "carrying" > "judging" (let go, the recorder decides)
//        > "returning" (the object goes back) > "ready" ...; "lost" while the connection is away
import { at, get, post } from "../api.js";
import { Carry } from "./hand_model.js";
import { Courier } from "./sample_sender.js";
import { name } from "./tracker_name.js";
import { pointer } from "./pointer_drag.js";
import { Prop } from "./carried_object.js";
import { Sampler } from "./fixed_rate_timer.js";
import { steering } from "./keyboard_gamepad.js";

const UNDECIDED = 4; // [s] after which a take of which nothing was heard is asked for
const ASK = 0.25; // [s] between two questions whether a take has been judged
const COST = 4; // times what a picture seems to take lie between two pictures, where they make samples late
const SELDOM = 10_000; // [ms] at most
const LITTLE = 20; // [ms] that need no sparing
const FORGET = 0.999; // with every sample in time
const REACH = 0.08; // [m] within which the recorder lets a hand grasp the object
const NEAR = 0.3; // [m] of the waiting object, where a hand may grasp it at any moment
const NOTHING = { kind: "sphere", size: [0.02], position: [0.58, -0.28, 0.6] }; // stands for the object of an empty scene

export class Showing {
  phase = "countdown";
  takes = []; // demonstrations of this sitting
  remark = ""; // on the last take, or why nothing is recorded
  #ends = [];
  #before = new Set(); // demonstrations of this page's earlier sittings
  #since = 0; // [s] in the phase
  #closed = false; // the headset's hand
  #over = false;
  #held = null; // where the object is for a pose of that hand
  #asked = 0;

  // `changed()` is called when phase or takes change; `failed(sentence)` ends the sitting.
  constructor({ easel, view }, scene, task, { changed, failed }) {
    Object.assign(this, { easel, view, task, changed, failed, name });
    const shown = { ...scene, carried: scene.carried ?? NOTHING };
    this.carry = new Carry(shown);
    this.prop = new Prop(easel, shown.carried);
    this.link = new Courier(name, { changed: (state, sentence) => this.#connection(state, sentence), refused: failed });
    this.sampler = new Sampler((seconds) => this.#tick(seconds), { late: (ms) => this.#spare(ms) });
  }

  // Connect and begin an armed recording; samples flow from now on. `rate` [Hz] is what they are declared to come at; a
  // headset's is not known: 0.
  async begin({ rate }) {
    await this.link.connect();
    this.#before = new Set((await this.#shown()).map((one) => one.id));
    if (this.#over) return; // finished meanwhile
    await post(at("tasks", this.task, "recording"), { tracker: name, rate, armed: true });
    if (this.#over) return; // the service ends it: the tracker has gone
    const deeds = { may: () => this.phase === "ready", grasp: () => this.grasp(), release: () => this.release() };
    this.steering = steering(this.easel, this.carry, deeds);
    this.#ends.push(pointer(this.easel, this.carry, deeds), () => this.steering.end());
    this.sampler.start();
    this.#draw();
  }

  // The countdown is over: record.
  async open() {
    await post(at("tasks", this.task, "recording", "resume"), { tracker: name });
    this.#enter("ready");
  }

  grasp() {
    if (this.phase !== "ready") return;
    this.carry.grasped = true;
    this.#enter("carrying");
  }

  release() {
    if (this.phase !== "carrying") return;
    this.carry.grasped = false;
    this.carry.target = [...this.carry.position]; // it stays where it was let go
    this.#enter("judging");
  }

  // End the recording; returns its account, or null when there is no connection.
  async finish({ discard = false } = {}) {
    this.#over = true;
    this.sampler.stop();
    for (const end of this.#ends.splice(0)) end();
    this.view.spare(0);
    try {
      return this.link.live ? await this.link.end({ discard }) : null;
    } finally {
      this.link.close();
      this.prop.remove();
    }
  }

  // A headset gives samples of its own, frame by frame, while the timer rests; `follow(null)` gives the hand back.
  follow(hand) {
    if (!hand) {
      this.#held = null;
      this.release();
      this.sampler.start();
      return;
    }
    this.sampler.stop();
    this.link.send(hand);
    if (hand.tracked && hand.grasp && !this.#closed && apart(hand.position, this.carry.home) < REACH) {
      this.#held = grip(this.easel.THREE, hand, this.carry.home);
      this.grasp();
    }
    if (!hand.grasp) this.release();
    this.#closed = hand.grasp;
    if (this.phase === "carrying") this.carry.position = this.prop.turn(this.#held(hand));
    else this.carry.step(hand.seconds);
    this.#draw();
    this.#live(hand.seconds);
  }

  // Whether a hand's samples belong to a take, or may do so at any moment: the next one begins where the last one ends.
  isTaking(hand) {
    if (this.phase === "ready") return apart(hand.position, this.carry.home) < NEAR;
    return ["carrying", "judging", "returning"].includes(this.phase);
  }

  #live(seconds) {
    this.#since += seconds;
    if (this.phase === "judging" && this.#since - this.#asked > ASK) {
      this.#asked = this.#since;
      this.#ask();
    }
    if (this.phase === "returning" && this.carry.isHome) this.#enter("ready");
  }

  #tick(seconds) {
    if (this.view.least) this.view.spare(this.view.least < LITTLE ? 0 : FORGET * this.view.least);
    this.steering.step(seconds);
    if (this.carry.step(seconds)) this.#draw();
    this.link.pose({ position: this.carry.position, orientation: null, tracked: true, grasp: this.carry.grasped });
    this.#live(seconds);
  }

  // Samples that come late: draw less, by as much as drawing seems to cost.
  #spare(ms) {
    this.view.spare(Math.min(SELDOM, Math.max(this.view.least, COST * ms)));
  }

  // What this page has shown of the task in this sitting.
  async #shown() {
    const all = await get(at("tasks", this.task, "demonstrations"));
    return all.filter((one) => one.source === name && !this.#before.has(one.id));
  }

  async #ask() {
    try {
      const shown = await this.#shown();
      if (this.phase !== "judging") return;
      if (shown.length > this.takes.length) {
        this.takes = shown;
        this.#next("");
      } else if (this.#since > UNDECIDED) {
        const running = await get(at("tasks", this.task, "recording"));
        this.#next(running.find((one) => one.tracker === name)?.notes.at(-1) ?? "The recorder has made nothing of it; show it again.");
      }
    } catch {
      // the connection's state says so already, and it is asked again
    }
  }

  #next(remark) {
    this.remark = remark;
    this.carry.goHome();
    this.prop.turn(null);
    this.#enter("returning");
  }

  #connection(state, sentence) {
    if (state === "refused") this.failed(sentence);
    if (state === "lost") {
      this.remark = sentence;
      this.carry.goHome();
      this.#enter("lost");
    }
    if (state === "live" && this.phase === "lost") this.#enter("returning");
  }

  #enter(phase) {
    this.phase = phase;
    this.#since = this.#asked = 0;
    this.#draw();
    this.changed();
  }

  #draw() {
    const { carry } = this;
    this.prop.place(carry.position, carry.below(carry.position), { grasped: carry.grasped, wrong: carry.touches(carry.position) });
  }
}

const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

// The object stays in the hand as it was grasped: returns what maps a later pose of the hand to that of the object.
function grip(THREE, hand, home) {
  const turned = ([w, x, y, z]) => new THREE.Quaternion(x, y, z, w);
  const back = turned(hand.orientation ?? [1, 0, 0, 0]).invert();
  const away = home.map((value, i) => value - hand.position[i]);
  return (later) => {
    const turn = turned(later.orientation ?? [1, 0, 0, 0]).multiply(back);
    const offset = new THREE.Vector3(...away).applyQuaternion(turn).toArray();
    return { position: later.position.map((value, i) => value + offset[i]), turn };
  };
}
