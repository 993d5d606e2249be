// Teleoperation: the arm follows a live hand while its clutch is held; why it slows down or stops is shown.
import { get, post, resourcePath } from "../api.js";
import { lease } from "../arm/lease.js";
import { block } from "../elements.js";
import { TeleopSession } from "../hand/teleop_session.js";
import { XrHand, xrUnavailableReason } from "../hand/xr_hand.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";
import { activeExecution, changesAny } from "../store.js";
import { createElements, HEADSET, PAGE_HAND, refill, teleopText } from "./teleop_elements.js";

const KEYS =
  "Lead the arm: hold Enter, arrows move, Page Up and Page Down change the height, G closes and opens the gripper";

/** @param {HTMLElement} place @param {Context} context */
export function teleopPanel(place, context) {
  const panel = new TeleopPanel(place, context);
  return {
    /** @type {Section["update"]} */
    update: (state, changed) => panel.update(state, changed),
    hide: () => panel.end(),
    session: () => panel.session,
    headset: () => panel.headset,
  };
}

class TeleopPanel {
  /** @type {TeleopSession | null} */
  session = null;
  /** @type {XrHand | null} */
  headset = null; // that is worn now
  #execution = ""; // id of the one that follows the hand
  #isBeginning = false;
  #turn = 0; // whoever ends it, also while it begins, is not overruled by answers that come later
  #listed = 0;

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.elements = createElements();
    const { all, begin, grip, finish, hand } = this.elements;
    place.append(...all);
    begin.addEventListener("click", () => this.#begin());
    grip.addEventListener("click", () => this.session?.toggleGripper());
    finish.addEventListener("click", () => this.end());
    hand.addEventListener("change", () => this.#render());
    navigator.xr?.addEventListener?.("devicechange", () => this.#listHands(context.store.state.trackers));
    this.#listHands([]);
    addEventListener("pagehide", () => this.session?.sender.close());
    this.jointStates = new ReconnectingSocket("joints", { onMessage: (text) => this.#onJointState(JSON.parse(text)) });
    this.#render();
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (changed.has("trackers")) this.#listHands(state.trackers);
    if (changesAny(changed, "executor", "connection", "lease")) this.#render();
  }

  /** Stop the arm where it is, and let the hand go. */
  async end() {
    this.#turn += 1;
    const execution = this.#execution;
    if (!this.session) return;
    this.#close();
    if (execution) await this.context.armStop.request(stopPath(execution));
  }

  async #begin() {
    if (this.#isBeginning || this.session) return;
    this.#isBeginning = true;
    this.#render();
    const turn = ++this.#turn;
    await this.context.attempt(() => this.#lead(() => turn === this.#turn));
    this.#isBeginning = false;
    if (!this.session || !this.#execution) {
      this.#close();
      return;
    }
    this.jointStates.open();
    const { usesPageHand, usesHeadset } = this.session;
    if (usesPageHand && !usesHeadset) this.context.overlay.setKeyboardLabel(KEYS);
    this.#render();
    this.elements.clutch.focus();
  }

  /**
   * Let the arm follow the hand that is chosen now.
   * @param {() => boolean} isWanted whether nobody has ended it meanwhile
   */
  async #lead(isWanted) {
    const [hand, calibration] = [this.elements.hand.value, this.elements.calibration.value];
    const usesHeadset = hand === HEADSET;
    const usesPageHand = usesHeadset || hand === PAGE_HAND;
    if (usesHeadset) await this.#startHeadset(); // the headset's session first: it must come from the click itself
    const [arm, scene] = await Promise.all([get("robot"), this.#readScene()]);
    if (!isWanted()) return;
    const session = new TeleopSession(this.context.overlay, scene, arm, {
      usesPageHand,
      usesHeadset,
      button: this.elements.clutch,
      onChange: () => this.#render(),
      onError: (why) => this.#onError(why),
    });
    this.session = session;
    try {
      await session.begin();
    } catch (error) {
      if (!isWanted()) return;
      throw error;
    }
    const tracker = usesPageHand ? { tracker: session.name } : { tracker: hand, calibration, clutch: session.name };
    const orientation = this.elements.orientation.value ? { orientation: this.elements.orientation.value } : {};
    const { id } = await post("teleoperation", { ...tracker, ...orientation, scene: scene.name }, lease.headers);
    if (isWanted()) this.#execution = id;
    else await this.context.armStop.request(stopPath(id));
  }

  async #startHeadset() {
    const { view } = this.context;
    const headset = new XrHand(view.viewer, {
      handedness: "right",
      onSample: (sample) => this.session?.sender.live && this.session.addHeadsetSample(sample),
      onEnd: () => {
        view.setFrameInterval(0);
        this.end();
      },
      onError: (why) => this.#onError(why),
    });
    await headset.start();
    view.setFrameInterval(Infinity); // nobody looks at the page meanwhile
    this.headset = headset;
  }

  /**
   * What stands around the arm: the chosen task's scene.
   * @returns {Promise<Scene>}
   */
  async #readScene() {
    const { task } = this.context.store.state;
    /** @type {[Scene[], {scene: string}]} */
    const [scenes, { scene }] = await Promise.all([
      get("scenes"),
      task ? get(resourcePath("tasks", task)) : { scene: "paper" },
    ]);
    return scenes.find(({ name }) => name === scene) ?? scenes[0];
  }

  /** @param {string} why */
  #onError(why) {
    this.end();
    this.context.messages.show(why, "error");
  }

  #close() {
    this.jointStates.close();
    this.headset?.end();
    this.session?.end();
    if (this.#execution && this.session?.usesPageHand) this.context.overlay.setKeyboardLabel("");
    this.session = this.headset = null;
    this.#execution = "";
    this.#render();
  }

  /** @param {import("./live_joints.js").JointState} state */
  #onJointState({ position, gripper_closed, status }) {
    if (!this.session) return;
    this.session.setArmState(position, gripper_closed);
    if (status) this.#showStatus(status);
  }

  /**
   * Say how the execution of this session stands; whoever stops the arm ends the session too.
   * @param {ExecutorStatus} status
   */
  #showStatus(status) {
    if (!this.session || status.execution !== this.#execution) return;
    if (["ended", "faulted"].includes(status.state)) {
      this.#close();
      const sentence = `The arm follows no hand any more: ${status.reason || "it was stopped"}.`;
      this.context.messages.show(sentence, status.state === "faulted" ? "error" : "note");
      return;
    }
    const text = teleopText(status, this.session);
    if (this.elements.statusText.textContent !== text) this.elements.statusText.textContent = text;
    this.headset?.rig.setText(text);
  }

  /**
   * Offer the hands that could lead: this page's, a headset's, and those of trackers other than pages.
   * @param {{name: string}[]} trackers
   */
  async #listHands(trackers) {
    const request = ++this.#listed;
    const headset = (await xrUnavailableReason()) === "" ? [HEADSET] : [];
    if (request !== this.#listed) return; // other trackers are here meanwhile
    const others = trackers.map(({ name }) => name).filter((name) => !name.startsWith("page-"));
    refill(this.elements.hand, [PAGE_HAND, ...headset, ...others]);
    if (trackers.length) {
      /** @type {MeasuredCalibration[] | null} */
      const measured = await get("calibrations").catch(() => null);
      const names = measured?.map(({ calibration }) => calibration.name);
      if (names && request === this.#listed) refill(this.elements.calibration, ["identity", ...new Set(names)]);
    }
    this.#render();
  }

  #render() {
    const { elements, session, context } = this;
    const { state } = context.store;
    const isOthers = Boolean(state.lease?.holder) && !lease.held;
    elements.idle.hidden = session !== null;
    elements.active.hidden = session === null;
    block(elements.begin, this.#isBeginning ? "It begins." : beginBlocker(state, isOthers));
    elements.calibrationField.hidden = [PAGE_HAND, HEADSET, ""].includes(elements.hand.value);
    if (!session) return;
    elements.grip.hidden = !session.usesPageHand || session.usesHeadset;
    elements.clutch.hidden = session.usesHeadset;
    block(elements.grip, session.clutchPressed ? "" : "Hold the clutch first.");
    elements.grip.textContent = session.handClosed ? "Open the gripper" : "Close the gripper";
    elements.clutch.classList.toggle("pressed", session.clutchPressed);
    elements.clutch.setAttribute("aria-pressed", String(session.clutchPressed));
    if (state.executor) this.#showStatus(state.executor);
  }
}

/** @param {State} state @param {boolean} isOthers somebody else holds control */
function beginBlocker(state, isOthers) {
  if (state.connection !== "live") return "The service does not answer.";
  if (activeExecution(state)) return "The arm is moving already.";
  return isOthers ? `${state.lease?.holder} holds control.` : "";
}

/** @param {string} execution */
const stopPath = (execution) => resourcePath("executions", execution, "stop");
