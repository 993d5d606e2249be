// A recording from the page's own hand: one demonstration after the other, until the session is finished.
//
// phase: "countdown" > "ready" (the object waits at its start) > "carrying" > "judging" (released, the recorder assesses)
//        > "returning" (the object goes back) > "ready" ...; "lost" while the connection is away
import { get, post, resourcePath } from "../api.js";
import { CarriedObject } from "./carried_object.js";
import { FixedRateTimer } from "./fixed_rate_timer.js";
import { HandModel } from "./hand_model.js";
import { attachKeyboardGamepad } from "./keyboard_gamepad.js";
import { attachPointerDrag } from "./pointer_drag.js";
import { SampleSender } from "./sample_sender.js";
import { TRACKER_NAME } from "./tracker_name.js";

const ASSESSMENT_TIMEOUT = 4; // [s] without a new demonstration, after which the recorder is asked why
const POLL_INTERVAL = 0.25; // [s] between two requests for the demonstrations
const COST_FACTOR = 4; // where drawing makes samples late, frames are this many times its cost apart
const MAX_FRAME_INTERVAL = 10_000; // [ms] at most
const MIN_FRAME_INTERVAL = 20; // [ms] below which the frame rate is not limited
const INTERVAL_DECAY = 0.999; // per sample that came in time
const GRASP_RADIUS = 0.08; // [m] within which the recorder lets a hand grasp the object
const APPROACH_RADIUS = 0.3; // [m] of the waiting object, where a hand may grasp it at any moment
const PLACEHOLDER = { kind: "sphere", size: [0.02], position: [0.58, -0.28, 0.6] }; // carried where the scene has no object

export class DemonstrationSession {
  phase = "countdown";
  demonstrations = []; // of this session
  note = ""; // on the last demonstration, or why nothing is recorded
  #disposers = [];
  #earlierDemonstrations = new Set(); // of this page's earlier sessions
  #phaseTime = 0; // [s] since the phase began
  #handClosed = false; // the headset's hand
  #over = false;
  #objectTransform = null; // maps a pose of that hand to the object's
  #lastPoll = 0;

  // `onChange()` is called when phase or demonstrations change, `onError(sentence)` when the session cannot go on.
  constructor({ overlay, view }, scene, task, { onChange, onError }) {
    Object.assign(this, { overlay, view, task, onChange, onError, name: TRACKER_NAME });
    const environment = { ...scene, carried: scene.carried ?? PLACEHOLDER };
    this.handModel = new HandModel(environment);
    this.carriedObject = new CarriedObject(overlay, environment.carried);
    this.sender = new SampleSender(TRACKER_NAME, {
      onChange: (state, sentence) => this.#onConnection(state, sentence),
      onRejected: onError,
    });
    this.timer = new FixedRateTimer((seconds) => this.#tick(seconds), { onLate: (ms) => this.#limitFrameRate(ms) });
  }

  // Connect and begin an armed recording; samples flow from now on. `rate` [Hz] is their declared rate; 0 for a headset,
  // whose rate is not known.
  async begin({ rate }) {
    await this.sender.connect();
    this.#earlierDemonstrations = new Set((await this.#ownDemonstrations()).map((one) => one.id));
    if (this.#over) return; // finished meanwhile
    await post(resourcePath("tasks", this.task, "recording"), { tracker: TRACKER_NAME, rate, armed: true });
    if (this.#over) return; // the service ends it: the tracker has gone
    const actions = {
      canGrasp: () => this.phase === "ready",
      grasp: () => this.grasp(),
      release: () => this.release(),
    };
    this.keyboardGamepad = attachKeyboardGamepad(this.overlay, this.handModel, actions);
    this.#disposers.push(attachPointerDrag(this.overlay, this.handModel, actions), () => this.keyboardGamepad.end());
    this.timer.start();
    this.#draw();
  }

  // The countdown is over: record.
  async startRecording() {
    await post(resourcePath("tasks", this.task, "recording", "resume"), { tracker: TRACKER_NAME });
    this.#setPhase("ready");
  }

  grasp() {
    if (this.phase !== "ready") return;
    this.handModel.grasped = true;
    this.#setPhase("carrying");
  }

  release() {
    if (this.phase !== "carrying") return;
    this.handModel.grasped = false;
    this.handModel.target = [...this.handModel.position]; // it stays where it was let go
    this.#setPhase("judging");
  }

  // End the recording; returns its account, or null when there is no connection.
  async finish({ discard = false } = {}) {
    this.#over = true;
    this.timer.stop();
    for (const end of this.#disposers.splice(0)) end();
    this.view.setFrameInterval(0);
    try {
      return this.sender.live ? await this.sender.end({ discard }) : null;
    } finally {
      this.sender.close();
      this.carriedObject.remove();
    }
  }

  // A headset gives samples of its own, frame by frame, while the timer rests; null ends that.
  setHeadsetSample(hand) {
    if (!hand) {
      this.#objectTransform = null;
      this.release();
      this.timer.start();
      return;
    }
    this.timer.stop();
    this.sender.send(hand);
    if (
      hand.tracked &&
      hand.grasp &&
      !this.#handClosed &&
      distance(hand.position, this.handModel.home) < GRASP_RADIUS
    ) {
      this.#objectTransform = graspTransform(this.overlay.THREE, hand, this.handModel.home);
      this.grasp();
    }
    if (!hand.grasp) this.release();
    this.#handClosed = hand.grasp;
    if (this.phase === "carrying")
      this.handModel.position = this.carriedObject.setOrientation(this.#objectTransform(hand));
    else this.handModel.step(hand.seconds);
    this.#draw();
    this.#advancePhase(hand.seconds);
  }

  // Whether a hand's samples belong to a demonstration, or may do so at any moment: the next one begins where the last ends.
  mayBeRecorded(hand) {
    if (this.phase === "ready") return distance(hand.position, this.handModel.home) < APPROACH_RADIUS;
    return ["carrying", "judging", "returning"].includes(this.phase);
  }

  #advancePhase(seconds) {
    this.#phaseTime += seconds;
    if (this.phase === "judging" && this.#phaseTime - this.#lastPoll > POLL_INTERVAL) {
      this.#lastPoll = this.#phaseTime;
      this.#pollDemonstrations();
    }
    if (this.phase === "returning" && this.handModel.isAtHome) this.#setPhase("ready");
  }

  #tick(seconds) {
    if (this.view.frameInterval)
      this.view.setFrameInterval(
        this.view.frameInterval < MIN_FRAME_INTERVAL ? 0 : INTERVAL_DECAY * this.view.frameInterval,
      );
    this.keyboardGamepad.step(seconds);
    if (this.handModel.step(seconds)) this.#draw();
    this.sender.setPose({
      position: this.handModel.position,
      orientation: null,
      tracked: true,
      grasp: this.handModel.grasped,
    });
    this.#advancePhase(seconds);
  }

  // Samples come late: draw less often, by as much as drawing seems to cost.
  #limitFrameRate(ms) {
    this.view.setFrameInterval(Math.min(MAX_FRAME_INTERVAL, Math.max(this.view.frameInterval, COST_FACTOR * ms)));
  }

  // The demonstrations of this session.
  async #ownDemonstrations() {
    const all = await get(resourcePath("tasks", this.task, "demonstrations"));
    return all.filter((one) => one.source === TRACKER_NAME && !this.#earlierDemonstrations.has(one.id));
  }

  async #pollDemonstrations() {
    try {
      const demonstrations = await this.#ownDemonstrations();
      if (this.phase !== "judging") return;
      if (demonstrations.length > this.demonstrations.length) {
        this.demonstrations = demonstrations;
        this.#returnObject("");
      } else if (this.#phaseTime > ASSESSMENT_TIMEOUT) {
        const running = await get(resourcePath("tasks", this.task, "recording"));
        this.#returnObject(
          running.find((one) => one.tracker === TRACKER_NAME)?.notes.at(-1) ??
            "The recorder has made nothing of it; show it again.",
        );
      }
    } catch {
      // the connection's state says so already, and it is asked again
    }
  }

  #returnObject(note) {
    this.note = note;
    this.handModel.returnHome();
    this.carriedObject.setOrientation(null);
    this.#setPhase("returning");
  }

  #onConnection(state, sentence) {
    if (state === "refused") this.onError(sentence);
    if (state === "lost") {
      this.note = sentence;
      this.handModel.returnHome();
      this.#setPhase("lost");
    }
    if (state === "live" && this.phase === "lost") this.#setPhase("returning");
  }

  #setPhase(phase) {
    this.phase = phase;
    this.#phaseTime = this.#lastPoll = 0;
    this.#draw();
    this.onChange();
  }

  #draw() {
    const { handModel } = this;
    this.carriedObject.setPosition(handModel.position, handModel.heightBelow(handModel.position), {
      grasped: handModel.grasped,
      colliding: handModel.collidingObstacle(handModel.position) !== "",
    });
  }
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

// The object stays in the hand as it was grasped: returns what maps a later pose of the hand to that of the object.
function graspTransform(THREE, hand, home) {
  const turned = ([w, x, y, z]) => new THREE.Quaternion(x, y, z, w);
  const back = turned(hand.orientation ?? [1, 0, 0, 0]).invert();
  const away = home.map((value, i) => value - hand.position[i]);
  return (later) => {
    const turn = turned(later.orientation ?? [1, 0, 0, 0]).multiply(back);
    const offset = new THREE.Vector3(...away).applyQuaternion(turn).toArray();
    return { position: later.position.map((value, i) => value + offset[i]), turn };
  };
}
