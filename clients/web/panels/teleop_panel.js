// Live hand: the arm follows a hand for as long as its clutch is held. What it says of limits and of what is near is told.
import { at, get, post } from "../api.js";
import { JointStream } from "../arm/joint_state_stream.js";
import { lease } from "../arm/lease.js";
import { element, facts, hint, replace, sentence } from "../elements.js";
import { Leading } from "../hand/teleop_session.js";
import { HeadsetHand, unavailable } from "../hand/xr_hand.js";

const HERE = "this page";
const WORN = "a headset";
const HOW = [
  ["Mouse, touch", "press on the ball at the gripper and drag; shift, the wheel or a second finger change the height"],
  ["Keyboard", "hold Enter; arrows, Page Up and Page Down move"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
  ["Gripper", "G, or the button, while the clutch is held"],
  ["Headset", "the right hand leads, its pinch or trigger closes the gripper; the left one's is the clutch"],
];
const WAITING = "press the clutch"; // how the executor begins to say that it does

export function leading(place, context) {
  const panel = new LeadingPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.end(), sitting: () => panel.sitting };
}

class LeadingPanel {
  #beginning = false;
  #turn = 0; // whoever ends it, also while it begins, is not overruled by answers that come later
  #offered = 0;

  constructor(place, context) {
    Object.assign(this, { context, parts: parts() });
    const { all, begin, grip, finish, hand } = this.parts;
    place.append(...all);
    begin.addEventListener("click", () => this.#begin());
    grip.addEventListener("click", () => this.sitting?.grip());
    finish.addEventListener("click", () => this.end());
    hand.addEventListener("change", () => this.#paint());
    navigator.xr?.addEventListener?.("devicechange", () => this.#offer(context.store.state.trackers));
    this.#offer([]);
    addEventListener("pagehide", () => this.sitting?.link.close());
    this.stream = new JointStream((frame) => this.#hear(frame));
    this.#paint();
  }

  update(state, changed) {
    if (changed.has("trackers")) this.#offer(state.trackers);
    if (["executor", "connection", "lease"].some((name) => changed.has(name))) this.#paint();
  }

  // Stop the arm where it is, and let the hand go.
  async end() {
    this.#turn += 1;
    const { sitting, execution } = this;
    if (!sitting) return;
    this.#close();
    if (execution) await this.context.attempt(() => post(at("executions", execution, "stop"), {}, lease.headers));
  }

  async #begin() {
    if (this.#beginning || this.sitting) return;
    this.#beginning = true;
    this.#paint();
    const turn = ++this.#turn;
    const begun = await this.context.attempt(() => this.#lead(() => turn === this.#turn));
    this.#beginning = false;
    if (!begun) {
      this.#close();
      return;
    }
    this.stream.start();
    const { own, worn } = this.sitting;
    if (own && !worn) this.context.easel.keys("Lead the arm: hold Enter, arrows move, Page Up and Page Down change the height, G closes and opens the gripper");
    this.#paint();
    this.parts.clutch.focus();
  }

  // Let the arm follow the hand that is chosen now; `wanted()` tells whether nobody has ended it meanwhile.
  async #lead(wanted) {
    const { hand: { value: hand }, clutch: button, calibration: { value: calibration } } = this.parts;
    const worn = hand === WORN;
    const own = worn || hand === HERE;
    if (worn) await this.#wear(); // the headset's session first: it must come from the click itself
    const [arm, scenes, scene] = await Promise.all([get("robot"), get("scenes"), this.#scene()]);
    if (!wanted()) return false;
    const deeds = { own, worn, button, changed: () => this.#paint(), failed: (why) => this.#fail(why) };
    const sitting = new Leading(this.context.easel, scenes.find(({ name }) => name === scene), arm, deeds);
    this.sitting = sitting;
    try {
      await sitting.begin();
    } catch (error) {
      if (!wanted()) return false;
      throw error;
    }
    const order = own ? { tracker: sitting.name } : { tracker: hand, calibration, clutch: sitting.name };
    const { id } = await post("teleoperation", { ...order, scene }, lease.headers);
    if (wanted()) this.execution = id;
    else await post(at("executions", id, "stop"), {}, lease.headers);
    return wanted();
  }

  async #wear() {
    const hand = new HeadsetHand(this.context.view.viewer, {
      only: "right",
      hear: (sample) => this.sitting?.link.live && this.sitting.hear(sample),
      ended: () => {
        this.context.view.spare(0);
        this.end();
      },
      failed: (why) => this.#fail(why),
    });
    await hand.start();
    this.context.view.spare(Infinity); // nobody looks at the page meanwhile
    this.worn = hand;
  }

  // What stands around the arm: the chosen task's scene.
  async #scene() {
    const { task } = this.context.store.state;
    return task ? (await get(at("tasks", task))).scene : "paper";
  }

  #fail(why) {
    this.end();
    this.context.messages.say(why, "error");
  }

  #close() {
    this.stream.stop();
    this.worn?.end();
    this.sitting?.end();
    if (this.execution && this.sitting?.own) this.context.easel.keys("");
    this.sitting = this.execution = this.worn = null;
    this.#paint();
  }

  #hear({ position, gripper_closed: gripped, status }) {
    if (!this.sitting) return;
    this.sitting.follow(position, gripped);
    if (status?.execution === this.execution) this.#tell(status);
  }

  // Whoever stops the arm ends the sitting too.
  #tell(status) {
    if (["ended", "faulted"].includes(status.state)) {
      this.#close();
      this.context.messages.say(`The arm follows no hand any more: ${status.reason || "it was stopped"}.`, status.state === "faulted" ? "error" : "note");
    } else this.#say(inWords(status, this.sitting));
  }

  #say(words) {
    if (this.parts.says.textContent !== words) this.parts.says.textContent = words;
    this.worn?.rig.say(words);
  }

  // Trackers that could lead: not the pages.
  async #offer(trackers) {
    const turn = ++this.#offered;
    const worn = (await unavailable()) === "" && WORN;
    if (turn !== this.#offered) return; // other trackers are here meanwhile
    const names = [HERE, worn, ...trackers.map(({ name }) => name).filter((name) => !name.startsWith("page-"))].filter(Boolean);
    const { hand } = this.parts;
    refill(hand, names);
    const measured = trackers.length && (await get("calibrations").catch(() => null));
    if (measured && turn === this.#offered) refill(this.parts.calibration, ["identity", ...new Set(measured.map(({ calibration }) => calibration.name))]);
    this.#paint();
  }

  #paint() {
    const { parts, sitting, context } = this;
    const { executor, connection, lease: there } = context.store.state;
    const busy = executor && !["idle", "ended", "faulted"].includes(executor.state);
    parts.idle.hidden = Boolean(sitting);
    parts.active.hidden = !sitting;
    parts.begin.disabled = this.#beginning || Boolean(busy) || connection !== "live" || Boolean(there?.holder && !lease.held);
    parts.from.hidden = [HERE, WORN, ""].includes(parts.hand.value);
    if (!sitting) return;
    parts.grip.hidden = !sitting.own || sitting.worn;
    parts.clutch.hidden = sitting.worn;
    parts.grip.disabled = !sitting.pressed;
    parts.grip.textContent = sitting.closed ? "Open the gripper" : "Close the gripper";
    parts.clutch.classList.toggle("pressed", sitting.pressed);
    parts.clutch.setAttribute("aria-pressed", String(sitting.pressed));
    if (executor?.execution === this.execution && executor) this.#tell(executor);
  }
}

// Offer other names; what is chosen stays chosen while it is there, else it is the first.
function refill(select, names) {
  const chosen = select.value;
  replace(select, names.map((name) => element("option", { value: name }, name)));
  select.value = names.includes(chosen) ? chosen : names[0];
}

function inWords({ state, reason, stretch }, { own, worn }) {
  const hindered = stretch.split(": ").slice(1).join(": ");
  if (state === "following") return hindered ? `The arm follows. ${sentence(hindered)}.` : "The arm follows.";
  if (state === "stopping") return "Let go: the arm comes to rest.";
  if (!reason.startsWith(WAITING)) return `The arm is held: ${reason}.`;
  if (worn) return "The arm is held. Close the left hand, and it follows the right one.";
  return own ? "The arm is held. Press on the ball at the gripper and drag it, or hold the clutch." : "The arm is held. Hold the clutch, and it follows the hand.";
}

function parts() {
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  const select = (id, ...options) => element("select", { id }, options.map((name) => element("option", { value: name }, name)));
  const field = (input, words) => element("p", { class: "field" }, element("label", { for: input.id }, words), input);
  const [hand, calibration] = [select("lead-hand", HERE), select("lead-calibration", "identity")];
  const from = field(calibration, "Calibration");
  const begin = button("Lead the arm", { class: "primary" });
  const idle = element("div", {}, hint("Move the arm by hand, without a path: it follows while the clutch is held, and rests when it is let go."), field(hand, "Hand"), from, element("p", { class: "orders" }, begin));
  const says = element("p", { class: "says", role: "status" });
  const clutch = button("Clutch: hold to move the arm", { class: "primary hold", "aria-pressed": "false", title: "Or hold Enter" });
  const [grip, finish] = [button("Close the gripper"), button("Finish")];
  const how = element("details", {}, element("summary", {}, "How to lead the arm"), facts(HOW));
  const active = element("div", { hidden: "" }, says, element("p", { class: "orders" }, clutch), element("p", { class: "orders" }, grip, finish), how);
  return { all: [idle, active], idle, active, hand, calibration, from, begin, says, clutch, grip, finish };
}
