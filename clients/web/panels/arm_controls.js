// The console of the arm: its state, a start that must be held, hold, resume, stop, the speed; steps; who holds control.
import { get, post, resourcePath } from "../api.js";
import { lease } from "../arm/lease.js";
import { block, blocked, closestData, element } from "../elements.js";
import { icon } from "../icons.js";
import { patchChildren } from "../patch_children.js";
import { activeExecution, changesAny } from "../store.js";
import { capitalize, formatPercent } from "../texts.js";
import { armFigures, armState, isTeleoperated } from "./arm_state.js";
import { bindHold } from "./hold_button.js";

const LEASE_POLL_INTERVAL = 2000; // [ms]
const STEP_LENGTH = 0.01; // [m]
const HOW_TO_START = "Keep the button pressed until the bar is full. The space bar stops the arm.";
/** What orders say of themselves. @type {Record<string, string>} */
const TITLES = {
  back: "Step back by a centimetre",
  step: "Step ahead by a centimetre",
  stop: "Or press the space bar",
};

/** @param {HTMLElement} place @param {Context} context */
export function armControls(place, context) {
  const panel = new ArmControls(place, context);
  return {
    driver: panel.elements.driver, // where stands what the arm itself says
    /** @type {Section["update"]} */
    update: (state, changed) => panel.update(state, changed),
    show: () => panel.show(),
    hide: () => panel.hide(),
  };
}

class ArmControls {
  #leaseRequests = 0;
  #leaseAnswered = 0; // the newest of them that was answered
  #polling = 0;
  #isSending = false; // an override
  #isOverrideNewer = false; // than the one that is being sent
  /** @type {number | null} */
  #sentOverride = null; // that the executor has not told yet

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.elements = createElements();
    place.append(...this.elements.all);
    const { start, commands, owner, speed, acknowledge } = this.elements;
    lease.onChange = () => this.#pollLease();
    commands.addEventListener("click", (event) => this.#sendCommand(closestData(event).verb ?? ""));
    owner.addEventListener("click", (event) => this.#changeLease(closestData(event).word ?? ""));
    speed.addEventListener("input", () => this.#sendOverride());
    acknowledge.addEventListener("click", () => {
      context.attempt(() => post("robot/acknowledge", {}, lease.headers));
    });
    bindHold(
      start,
      () => context.store.state.plan,
      (plan) => {
        // Else it is not what was looked at when it was pressed.
        if (plan && plan.id === context.store.state.plan?.id) this.#start(plan);
      },
    );
  }

  show() {
    this.#polling = setInterval(() => document.hidden || this.#pollLease(), LEASE_POLL_INTERVAL);
    this.#pollLease();
  }

  hide() {
    clearInterval(this.#polling);
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (changesAny(changed, "executor", "executions", "plan", "lease", "connection")) this.#render(state);
  }

  /** Ask who holds control: the executor alone knows. An answer that comes behind that of a later request is too old. */
  async #pollLease() {
    const request = ++this.#leaseRequests;
    const answer = await get("lease").catch(() => null);
    if (request < this.#leaseAnswered) return;
    this.#leaseAnswered = request;
    this.context.store.set({ lease: answer });
    this.#render(this.context.store.state);
  }

  /** @param {string} word of a button */
  #changeLease(word) {
    const { attempt } = this.context;
    if (word === "take") attempt(() => lease.take(this.#operatorName()));
    if (word === "ask") attempt(() => lease.ask(this.#operatorName()));
    if (word === "keep") attempt(() => lease.keep());
    if (word === "release") attempt(() => lease.release());
  }

  /** @param {Plan} plan */
  #start(plan) {
    const { context, elements } = this;
    context.attempt(async () => {
      await post("executions", { plan: plan.id, override: Number(elements.speed.value) / 100 }, lease.headers);
      await context.eventStream.read("executions");
    });
  }

  /** @param {string} verb of a button */
  #sendCommand(verb) {
    const status = activeExecution(this.context.store.state);
    if (verb === "stop") this.context.armStop.request();
    if (!status || !verb || verb === "stop") return;
    const isStep = verb === "step" || verb === "back";
    const body = isStep ? { length: verb === "back" ? -STEP_LENGTH : STEP_LENGTH } : {};
    const path = resourcePath("executions", status.execution, isStep ? "step" : verb);
    this.context.attempt(() => post(path, body, lease.headers));
  }

  /** While the slider moves the newest speed is sent, one request at a time. */
  async #sendOverride() {
    const { speed, share } = this.elements;
    share.textContent = formatPercent(Number(speed.value) / 100);
    this.#isOverrideNewer = true;
    if (this.#isSending) return;
    this.#isSending = true;
    while (this.#isOverrideNewer) {
      this.#isOverrideNewer = false;
      const status = activeExecution(this.context.store.state);
      if (!status) continue;
      const [path, override] = [resourcePath("executions", status.execution, "override"), Number(speed.value) / 100];
      this.#sentOverride = override;
      const answer = await this.context.attempt(() => post(path, { override }, lease.headers).then(() => true));
      if (!answer) this.#sentOverride = null;
    }
    this.#isSending = false;
  }

  /** Show the speed at which the arm goes, but for one that it has just been told. @param {ExecutorStatus | null} active */
  #showOverride(active) {
    const { speed, share } = this.elements;
    if (!active || Math.abs(active.override - (this.#sentOverride ?? active.override)) < 0.005)
      this.#sentOverride = null;
    if (!active || this.#isSending || this.#sentOverride !== null || speed.matches(":active")) return;
    speed.value = String(Math.round(100 * active.override));
    share.textContent = formatPercent(active.override);
  }

  #operatorName() {
    const name = this.elements.name.value.trim() || "this page";
    localStorage.setItem("operator", name);
    return name;
  }

  /** @param {State} state */
  #render(state) {
    const { elements } = this;
    const active = activeExecution(state);
    const last = state.executor?.execution ? state.executor : state.executions?.[0]?.status;
    const isAway = state.connection === "lost";
    const status = active ?? last;
    patchChildren(elements.state, armState(status, isAway));
    patchChildren(elements.figures, !isAway && status && armFigures(status, active !== null));
    const isOthers = Boolean(state.lease?.holder) && !lease.held;
    const unasked = (!isAway && state.executor?.unasked_motion) || "";
    elements.driver.hidden = isAway;
    elements.unasked.hidden = unasked === "";
    elements.unaskedText.textContent = unasked && `${capitalize(unasked)}.`;
    const why = startBlocker(state, active, isOthers);
    block(elements.start, why);
    elements.why.textContent = isAway || active ? "" : why || HOW_TO_START;
    elements.why.hidden = elements.why.textContent === "";
    for (const button of elements.commands.querySelectorAll("button"))
      block(button, orderBlocker(button.dataset.verb, active), TITLES[button.dataset.verb ?? ""]);
    this.#showOverride(active);
    patchChildren(elements.owner, isAway ? "Who holds control is not known." : leaseOwner(state.lease));
    elements.nameField.hidden = lease.token !== "";
  }
}

/**
 * Why the arm cannot be started now, and what to do; "" when it can.
 * @param {State} state
 * @param {ExecutorStatus | null} active
 * @param {boolean} isOthers somebody else holds control
 */
function startBlocker(state, active, isOthers) {
  if (state.connection === "lost") return "The service does not answer.";
  if (active) return "The arm is moving already.";
  if (state.executor?.unasked_motion) return "It starts when somebody has acknowledged that the arm moved.";
  if (!state.plan) return "It starts with a certified motion only: plan one below.";
  return isOthers ? `${state.lease?.holder} holds control: ask for it below.` : "";
}

/**
 * Why an order makes no sense now; "" when it does. The arm is held before it steps, and runs before it is held. Stop does
 * while anything moves, and reverse where there is a path: not with a live hand.
 * @param {string | undefined} verb
 * @param {ExecutorStatus | null} status
 */
function orderBlocker(verb = "", status) {
  if (!status) return "Nothing moves the arm.";
  const isHeld = status.state === "held";
  if (verb === "hold") return isHeld ? "It is held already." : "";
  if (isTeleoperated(status) && ["step", "back", "reverse"].includes(verb)) return "A live hand leads the arm.";
  return ["resume", "step", "back"].includes(verb) && !isHeld ? "The arm is not held." : "";
}

/**
 * Who holds control, and what can be done about it.
 * @param {LeaseState | null} state
 * @returns {Child[]}
 */
function leaseOwner(state) {
  /** @param {string} word @param {string} text */
  const order = (word, text) => element("button", { type: "button", "data-word": word, "data-key": word }, text);
  const { holder = "", asking = "" } = state ?? {};
  if (lease.waiting) {
    return [`${holder || "Somebody"} holds control and was asked for it. `, order("release", "Ask no more")];
  }
  if (lease.held) {
    const request = asking && [`${asking} asks for it. `, order("keep", "Keep it")];
    return ["You hold control. ", request, order("release", "Give it back")];
  }
  if (holder) return [`${holder} holds control. `, order("ask", "Ask for it")];
  return ["Nobody holds control; every page may give orders. ", order("take", "Take control")];
}

function createElements() {
  const unasked = unaskedParts();
  /** @param {string} verb @param {string} drawing @param {string} text */
  const order = (verb, drawing, text) =>
    element("button", { type: "button", "data-verb": verb, title: TITLES[verb] }, icon(drawing), text);
  const start = element(
    "button",
    { type: "button", class: "primary hold", ...blocked("It is not known yet how the arm stands.") },
    icon("start"),
    "Keep pressed to start the arm",
  );
  const why = element("p", { class: "note" });
  const speed = element("input", { type: "range", id: "speed", min: "0", max: "100", step: "1", value: "100" });
  const share = element("output", { for: "speed" }, formatPercent(1));
  const [hold, resume, stop] = [
    order("hold", "hold", "Hold"),
    order("resume", "resume", "Resume"),
    order("stop", "stop", "Stop"),
  ];
  const [back, ahead, reverse] = [
    order("back", "back", "− 1 cm"),
    order("step", "ahead", "+ 1 cm"),
    order("reverse", "reverse", "Reverse"),
  ];
  const commands = element(
    "div",
    { class: "steer" },
    element("p", { class: "buttons" }, hold, resume, stop),
    element("p", { class: "field" }, element("label", { for: "speed" }, "Speed"), speed, share),
    element("p", { class: "buttons" }, back, ahead, reverse),
  );
  const [state, figures, driver] = [element("div", {}), element("div", {}), element("div", { class: "driver" })];
  const owner = element("p", { class: "who" });
  const text = { type: "text", maxlength: "64", placeholder: "shown to everybody", autocomplete: "off" };
  const name = element("input", { ...text, id: "operator", value: localStorage.getItem("operator") ?? "" });
  const nameField = element("p", { class: "field" }, element("label", { for: "operator" }, "Your name"), name);
  const all = [state, unasked.unasked, start, why, commands, figures, driver, owner, nameField];
  return { all, ...unasked, state, start, why, commands, speed, share, figures, driver, owner, name, nameField };
}

/** What says that the arm moved unasked. */
function unaskedParts() {
  const unaskedText = element("span", {});
  const acknowledge = element("button", { type: "button" }, "I have seen why: acknowledge");
  const unasked = element(
    "div",
    { role: "alert", hidden: "" },
    element("p", { class: "failed" }, unaskedText),
    element("p", { class: "buttons" }, acknowledge),
  );
  return { unasked, unaskedText, acknowledge };
}
