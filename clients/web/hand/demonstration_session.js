// A recording from the page's own hand: one demonstration after the other, until the session is finished.
//
// phase: "countdown" > "ready" (the object waits at its start) > "carrying" > "judging" (released, the recorder assesses)
//        > "returning" (the object goes back) > "ready" ...; "lost" while the connection is away
import { get, post, resourcePath } from "../api.js";
import { distance } from "../polyline.js";
import { CarriedObject } from "./carried_object.js";
import { FixedRateTimer } from "./fixed_rate_timer.js";
import { FrameRateLimiter } from "./frame_rate_limiter.js";
import { graspTransform } from "./grasp_transform.js";
import { HandModel } from "./hand_model.js";
import { attachKeyboardGamepad } from "./keyboard_gamepad.js";
import { attachPointerDrag } from "./pointer_drag.js";
import { SampleSender } from "./sample_sender.js";
import { TRACKER_NAME } from "./tracker_name.js";

const ASSESSMENT_TIMEOUT = 4; // [s] without a new demonstration, after which the recorder is asked why
const POLL_INTERVAL = 0.25; // [s] between two requests for the demonstrations
const GRASP_RADIUS = 0.08; // [m] within which the recorder lets a hand grasp the object
const APPROACH_RADIUS = 0.3; // [m] of the waiting object, where a hand may grasp it at any moment
const PLACEHOLDER = { kind: "sphere", size: [0.02], position: [0.58, -0.28, 0.6] }; // carried where the scene has no object

/**
 * @typedef {object} SessionCallbacks
 * @property {() => void} onChange phase or demonstrations have changed
 * @property {(sentence: string) => void} onError the session cannot go on
 */

export class DemonstrationSession {
  phase = "countdown";
  /** @type {Demonstration[]} */
  demonstrations = []; // of this session
  note = ""; // on the last demonstration, or why nothing is recorded
  /** @type {(() => void)[]} */
  #disposers = [];
  /** @type {Set<string>} */
  #earlierDemonstrations = new Set(); // of this page's earlier sessions
  #phaseTime = 0; // [s] since the phase began
  #handClosed = false; // the headset's hand
  #isFinished = false;
  /** @type {ReturnType<typeof graspTransform> | null} */
  #objectTransform = null; // maps a pose of that hand to the object's
  #lastPoll = 0;

  /**
   * @param {Pick<Context, "overlay" | "view">} context
   * @param {Scene} scene
   * @param {string} task
   * @param {SessionCallbacks} callbacks
   */
  constructor({ overlay, view }, scene, task, { onChange, onError }) {
    this.overlay = overlay;
    this.scene = scene;
    this.task = task;
    this.onChange = onChange;
    this.onError = onError;
    const surroundings = { obstacles: scene.obstacles, carried: scene.carried ?? PLACEHOLDER };
    this.handModel = new HandModel(surroundings);
    this.carriedObject = new CarriedObject(overlay, surroundings.carried);
    this.frameRate = new FrameRateLimiter(view);
    this.sender = new SampleSender(TRACKER_NAME, {
      onChange: (state, sentence) => this.#onConnection(state, sentence),
      onRejected: onError,
    });
    this.timer = new FixedRateTimer((seconds) => this.#tick(seconds), { onLate: (ms) => this.frameRate.onLate(ms) });
  }

  /**
   * Connect and begin an armed recording; samples flow from now on.
   * @param {{rate: number}} options `rate` [Hz]: that of the samples, as it is declared; 0 for a headset, whose rate is not
   *   known
   */
  async begin({ rate }) {
    await this.sender.connect();
    this.#earlierDemonstrations = new Set((await this.#ownDemonstrations()).map((one) => one.id));
    if (this.#isFinished) return; // meanwhile
    await post(resourcePath("tasks", this.task, "recording"), { tracker: TRACKER_NAME, rate, armed: true });
    if (this.#isFinished) return; // the service ends it: the tracker has gone
    const actions = {
      canGrasp: () => this.phase === "ready",
      grasp: () => this.grasp(),
      release: () => this.release(),
    };
    const keyboardGamepad = attachKeyboardGamepad(this.overlay, this.handModel, actions);
    this.keyboardGamepad = keyboardGamepad;
    this.#disposers.push(attachPointerDrag(this.overlay, this.handModel, actions), () => keyboardGamepad.end());
    this.timer.start();
    this.#draw();
  }

  /** The countdown is over: record. */
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

  /** End the recording; returns its report, or null when there is no connection. */
  async finish({ discard = false } = {}) {
    this.#isFinished = true;
    this.timer.stop();
    for (const dispose of this.#disposers.splice(0)) dispose();
    this.frameRate.release();
    try {
      return this.sender.live ? await this.sender.end({ discard }) : null;
    } finally {
      this.sender.close();
      this.carriedObject.remove();
    }
  }

  /**
   * Take a sample of a headset, which gives them frame by frame, while the timer rests.
   * @param {HandSample & {seconds: number}} hand
   */
  setHeadsetSample(hand) {
    this.timer.stop();
    this.sender.send(hand);
    const closes = hand.tracked && hand.grasp && !this.#handClosed;
    if (closes && distance(hand.position, this.handModel.home) < GRASP_RADIUS) {
      this.#objectTransform = graspTransform(hand, this.handModel.home);
      this.grasp();
    }
    if (!hand.grasp) this.release();
    this.#handClosed = hand.grasp;
    if (this.phase === "carrying" && this.#objectTransform) {
      const { position, turn } = this.#objectTransform(hand);
      this.handModel.position = position;
      this.carriedObject.setOrientation(turn);
    } else this.handModel.step(hand.seconds);
    this.#draw();
    this.#advancePhase(hand.seconds);
  }

  /** The headset's session is over: the page's own hand is sampled again. */
  endHeadset() {
    this.#objectTransform = null;
    this.release();
    this.timer.start();
  }

  /**
   * Whether a hand's samples belong to a demonstration, or may do so at any moment: the next one begins where the last ends.
   * @param {Hand} hand
   */
  mayBeRecorded(hand) {
    if (this.phase === "ready") return distance(hand.position, this.handModel.home) < APPROACH_RADIUS;
    return ["carrying", "judging", "returning"].includes(this.phase);
  }

  /** @param {number} seconds */
  #advancePhase(seconds) {
    this.#phaseTime += seconds;
    if (this.phase === "judging" && this.#phaseTime - this.#lastPoll > POLL_INTERVAL) {
      this.#lastPoll = this.#phaseTime;
      this.#pollDemonstrations();
    }
    if (this.phase === "returning" && this.handModel.isAtHome) this.#setPhase("ready");
  }

  /** @param {number} seconds */
  #tick(seconds) {
    this.frameRate.onSample();
    this.keyboardGamepad?.step(seconds);
    if (this.handModel.step(seconds)) this.#draw();
    const { position, grasped: grasp } = this.handModel;
    this.sender.setPose({ position, orientation: null, tracked: true, grasp });
    this.#advancePhase(seconds);
  }

  /** @returns {Promise<Demonstration[]>} those of this session */
  async #ownDemonstrations() {
    /** @type {Demonstration[]} */
    const all = await get(resourcePath("tasks", this.task, "demonstrations"));
    return all.filter((one) => one.source === TRACKER_NAME && !this.#earlierDemonstrations.has(one.id));
  }

  async #pollDemonstrations() {
    try {
      const demonstrations = await this.#ownDemonstrations();
      if (this.phase !== "judging") return;
      if (demonstrations.length > this.demonstrations.length) {
        this.demonstrations = demonstrations;
        await this.#findObject();
        this.#returnObject("");
      } else if (this.#phaseTime > ASSESSMENT_TIMEOUT) this.#returnObject(await this.#recorderNote());
    } catch {
      // the connection's state says so already, and it is asked again
    }
  }

  /** The next demonstration begins where the object lies then; it may have been told to lie elsewhere. */
  async #findObject() {
    if (!this.scene.carried) return;
    /** @type {{position: Point}} */
    const { position } = await get(resourcePath("scenes", this.scene.name, "object"));
    this.handModel.home = position;
  }

  /** Why the recorder has made no demonstration. */
  async #recorderNote() {
    /** @type {{tracker: string, notes: string[]}[]} */
    const running = await get(resourcePath("tasks", this.task, "recording"));
    const note = running.find((one) => one.tracker === TRACKER_NAME)?.notes.at(-1);
    return note ?? "The recorder has made nothing of it; show it again.";
  }

  /** @param {string} note */
  #returnObject(note) {
    this.note = note;
    this.handModel.returnHome();
    this.carriedObject.setOrientation(null);
    this.#setPhase("returning");
  }

  /** @param {string} state @param {string} sentence */
  #onConnection(state, sentence) {
    if (state === "refused") this.onError(sentence);
    if (state === "lost") {
      this.note = sentence;
      this.handModel.returnHome();
      this.#setPhase("lost");
    }
    if (state === "live" && this.phase === "lost") this.#setPhase("returning");
  }

  /** @param {string} phase */
  #setPhase(phase) {
    this.phase = phase;
    this.#phaseTime = this.#lastPoll = 0;
    this.#draw();
    this.onChange();
  }

  #draw() {
    const { position, grasped } = this.handModel;
    const colliding = this.handModel.collidingObstacle(position) !== "";
    this.carriedObject.setPosition(position, this.handModel.heightBelow(position), { grasped, colliding });
  }
}
