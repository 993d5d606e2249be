// Teleoperation: the arm follows a live hand while its clutch is held; why it slows down or stops is shown.
import { get, post, resourcePath } from "../api.js";
import { lease } from "../arm/lease.js";
import { capitalize, definitionList, element, hint, patchChildren } from "../elements.js";
import { TeleopSession } from "../hand/teleop_session.js";
import { XrHand, xrUnavailableReason } from "../hand/xr_hand.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";

const PAGE_HAND = "this page";
const HEADSET = "a headset";
const HELP = [
  ["Mouse, touch", "press on the ball at the gripper and drag; shift, the wheel or a second finger change the height"],
  ["Keyboard", "hold Enter; arrows, Page Up and Page Down move"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
  ["Gripper", "G, or the button, while the clutch is held"],
  ["Headset", "the right hand leads, its pinch or trigger closes the gripper; the left one's is the clutch"],
];
const WAITING_FOR_CLUTCH = "press the clutch"; // the executor's reason begins so while it waits

export function teleopPanel(place, context) {
  const panel = new TeleopPanel(place, context);
  return {
    update: (state, changed) => panel.update(state, changed),
    hide: () => panel.end(),
    session: () => panel.session,
  };
}

class TeleopPanel {
  #beginning = false;
  #turn = 0; // whoever ends it, also while it begins, is not overruled by answers that come later
  #offered = 0;

  constructor(place, context) {
    Object.assign(this, { context, parts: parts() });
    const { all, begin, grip, finish, hand } = this.parts;
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

  update(state, changed) {
    if (changed.has("trackers")) this.#listHands(state.trackers);
    if (["executor", "connection", "lease"].some((name) => changed.has(name))) this.#render();
  }

  // Stop the arm where it is, and let the hand go.
  async end() {
    this.#turn += 1;
    const { session, execution } = this;
    if (!session) return;
    this.#close();
    if (execution)
      await this.context.attempt(() => post(resourcePath("executions", execution, "stop"), {}, lease.headers));
  }

  async #begin() {
    if (this.#beginning || this.session) return;
    this.#beginning = true;
    this.#render();
    const turn = ++this.#turn;
    const begun = await this.context.attempt(() => this.#lead(() => turn === this.#turn));
    this.#beginning = false;
    if (!begun) {
      this.#close();
      return;
    }
    this.jointStates.open();
    const { usesPageHand, usesHeadset } = this.session;
    if (usesPageHand && !usesHeadset)
      this.context.overlay.setKeyboardLabel(
        "Lead the arm: hold Enter, arrows move, Page Up and Page Down change the height, G closes and opens the gripper",
      );
    this.#render();
    this.parts.clutch.focus();
  }

  // Let the arm follow the hand that is chosen now; `wanted()` tells whether nobody has ended it meanwhile.
  async #lead(wanted) {
    const {
      hand: { value: hand },
      clutch: button,
      calibration: { value: calibration },
    } = this.parts;
    const usesHeadset = hand === HEADSET;
    const usesPageHand = usesHeadset || hand === PAGE_HAND;
    if (usesHeadset) await this.#startHeadset(); // the headset's session first: it must come from the click itself
    const [arm, scenes, scene] = await Promise.all([get("robot"), get("scenes"), this.#scene()]);
    if (!wanted()) return false;
    const options = {
      usesPageHand,
      usesHeadset,
      button,
      onChange: () => this.#render(),
      onError: (why) => this.#onError(why),
    };
    const session = new TeleopSession(
      this.context.overlay,
      scenes.find(({ name }) => name === scene),
      arm,
      options,
    );
    this.session = session;
    try {
      await session.begin();
    } catch (error) {
      if (!wanted()) return false;
      throw error;
    }
    const order = usesPageHand ? { tracker: session.name } : { tracker: hand, calibration, clutch: session.name };
    const { id } = await post("teleoperation", { ...order, scene }, lease.headers);
    if (wanted()) this.execution = id;
    else await post(resourcePath("executions", id, "stop"), {}, lease.headers);
    return wanted();
  }

  async #startHeadset() {
    const hand = new XrHand(this.context.view.viewer, {
      handedness: "right",
      onSample: (sample) => this.session?.sender.live && this.session.addHeadsetSample(sample),
      onEnd: () => {
        this.context.view.setFrameInterval(0);
        this.end();
      },
      onError: (why) => this.#onError(why),
    });
    await hand.start();
    this.context.view.setFrameInterval(Infinity); // nobody looks at the page meanwhile
    this.headset = hand;
  }

  // What stands around the arm: the chosen task's scene.
  async #scene() {
    const { task } = this.context.store.state;
    return task ? (await get(resourcePath("tasks", task))).scene : "paper";
  }

  #onError(why) {
    this.end();
    this.context.messages.show(why, "error");
  }

  #close() {
    this.jointStates.close();
    this.headset?.end();
    this.session?.end();
    if (this.execution && this.session?.usesPageHand) this.context.overlay.setKeyboardLabel("");
    this.session = this.execution = this.headset = null;
    this.#render();
  }

  #onJointState({ position, gripper_closed: gripperClosed, status }) {
    if (!this.session) return;
    this.session.setArmState(position, gripperClosed);
    if (status?.execution === this.execution) this.#showStatus(status);
  }

  // Whoever stops the arm ends the session too.
  #showStatus(status) {
    if (["ended", "faulted"].includes(status.state)) {
      this.#close();
      this.context.messages.show(
        `The arm follows no hand any more: ${status.reason || "it was stopped"}.`,
        status.state === "faulted" ? "error" : "note",
      );
    } else this.#setStatusText(teleopStatusText(status, this.session));
  }

  #setStatusText(words) {
    if (this.parts.statusText.textContent !== words) this.parts.statusText.textContent = words;
    this.headset?.rig.setText(words);
  }

  // Hands that could lead: this page's, a headset's, and those of trackers other than pages.
  async #listHands(trackers) {
    const turn = ++this.#offered;
    const headset = (await xrUnavailableReason()) === "" && HEADSET;
    if (turn !== this.#offered) return; // other trackers are here meanwhile
    const names = [
      PAGE_HAND,
      headset,
      ...trackers.map(({ name }) => name).filter((name) => !name.startsWith("page-")),
    ].filter(Boolean);
    const { hand } = this.parts;
    refill(hand, names);
    const measured = trackers.length && (await get("calibrations").catch(() => null));
    if (measured && turn === this.#offered)
      refill(this.parts.calibration, ["identity", ...new Set(measured.map(({ calibration }) => calibration.name))]);
    this.#render();
  }

  #render() {
    const { parts, session, context } = this;
    const { executor, connection, lease: there } = context.store.state;
    const busy = executor && !["idle", "ended", "faulted"].includes(executor.state);
    parts.idle.hidden = Boolean(session);
    parts.active.hidden = !session;
    parts.begin.disabled =
      this.#beginning || Boolean(busy) || connection !== "live" || Boolean(there?.holder && !lease.held);
    parts.from.hidden = [PAGE_HAND, HEADSET, ""].includes(parts.hand.value);
    if (!session) return;
    parts.grip.hidden = !session.usesPageHand || session.usesHeadset;
    parts.clutch.hidden = session.usesHeadset;
    parts.grip.disabled = !session.clutchPressed;
    parts.grip.textContent = session.handClosed ? "Open the gripper" : "Close the gripper";
    parts.clutch.classList.toggle("pressed", session.clutchPressed);
    parts.clutch.setAttribute("aria-pressed", String(session.clutchPressed));
    if (executor?.execution === this.execution && executor) this.#showStatus(executor);
  }
}

// Offer other names; what is chosen stays chosen while it is there, else it is the first.
function refill(select, names) {
  const chosen = select.value;
  patchChildren(
    select,
    names.map((name) => element("option", { value: name }, name)),
  );
  select.value = names.includes(chosen) ? chosen : names[0];
}

function teleopStatusText({ state, reason, stretch }, { usesPageHand, usesHeadset }) {
  const hindered = stretch.split(": ").slice(1).join(": ");
  if (state === "following") return hindered ? `The arm follows. ${capitalize(hindered)}.` : "The arm follows.";
  if (state === "stopping") return "Let go: the arm comes to rest.";
  if (!reason.startsWith(WAITING_FOR_CLUTCH)) return `The arm is held: ${reason}.`;
  if (usesHeadset) return "The arm is held. Close the left hand, and it follows the right one.";
  return usesPageHand
    ? "The arm is held. Press on the ball at the gripper and drag it, or hold the clutch."
    : "The arm is held. Hold the clutch, and it follows the hand.";
}

function parts() {
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  const select = (id, ...options) =>
    element(
      "select",
      { id },
      options.map((name) => element("option", { value: name }, name)),
    );
  const field = (input, words) => element("p", { class: "field" }, element("label", { for: input.id }, words), input);
  const [hand, calibration] = [select("teleop-hand", PAGE_HAND), select("teleop-calibration", "identity")];
  const from = field(calibration, "Calibration");
  const begin = button("Lead the arm", { class: "primary" });
  const idle = element(
    "div",
    {},
    hint("Move the arm by hand, without a path: it follows while the clutch is held, and rests when it is let go."),
    field(hand, "Hand"),
    from,
    element("p", { class: "buttons" }, begin),
  );
  const statusText = element("p", { class: "session-status", role: "status" });
  const clutch = button("Clutch: hold to move the arm", {
    class: "primary hold",
    "aria-pressed": "false",
    title: "Or hold Enter",
  });
  const [grip, finish] = [button("Close the gripper"), button("Finish")];
  const how = element("details", {}, element("summary", {}, "How to lead the arm"), definitionList(HELP));
  const active = element(
    "div",
    { hidden: "" },
    statusText,
    element("p", { class: "buttons" }, clutch),
    element("p", { class: "buttons" }, grip, finish),
    how,
  );
  return { all: [idle, active], idle, active, hand, calibration, from, begin, statusText, clutch, grip, finish };
}
