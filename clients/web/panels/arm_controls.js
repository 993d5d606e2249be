// The arm: its state, a start that must be held, hold, resume, step, reverse, the speed; who holds control.
import { get, post, resourcePath } from "../api.js";
import { lease } from "../arm/lease.js";
import {
  capitalize,
  definitionList,
  element,
  formatNumber,
  formatPercent,
  patchChildren,
  progressBar,
} from "../elements.js";
import { activeExecution } from "../store.js";

const START_HOLD = 800; // [ms] that the start must be held
const LEASE_POLL_INTERVAL = 2000; // [ms]
const STEP_LENGTH = 0.01; // [m]
export const STATE_LABELS = {
  idle: "At rest",
  starting: "Starting",
  approaching: "On the way to the path",
  following: "On the path",
  held: "Held on the path",
  stopping: "Coming to rest",
  ended: "Ended",
  faulted: "Given up",
};

export function armControls(place, context) {
  const panel = new ArmControls(place, context);
  return {
    update: (state, changed) => panel.update(state, changed),
    show: () => panel.show(),
    hide: () => panel.hide(),
  };
}

class ArmControls {
  #asked = 0; // questions who holds control
  #answered = 0; // the newest of them that was answered

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.lease = lease;
    lease.changed = () => this.#pollLease();
    this.parts = parts();
    place.append(...this.parts.all);
    this.parts.buttons.addEventListener("click", (event) => {
      const verb = event.target.closest("button[data-verb]")?.dataset.verb;
      if (verb) this.#sendCommand(verb);
    });
    this.parts.who.addEventListener("click", (event) => {
      const word = event.target.closest("button[data-word]")?.dataset.word;
      if (word) context.attempt(() => this.lease[word](this.#name()));
    });
    this.parts.speed.addEventListener("input", () => this.#sendOverride());
    this.#bindHoldToStart(this.parts.start);
  }

  show() {
    this.looking = setInterval(() => document.hidden || this.#pollLease(), LEASE_POLL_INTERVAL);
    this.#pollLease();
  }

  hide() {
    clearInterval(this.looking);
  }

  update(state, changed) {
    if (["executor", "executions", "plan", "lease", "connection"].some((name) => changed.has(name)))
      this.#render(state);
  }

  // Who holds control: the executor alone knows. An answer that comes behind that of a later question is too old.
  async #pollLease() {
    const question = ++this.#asked;
    const lease = await get("lease").catch(() => null);
    if (question < this.#answered) return;
    this.#answered = question;
    this.context.store.set({ lease });
    this.#render(this.context.store.state);
  }

  // The start begins only when the button has been held for a while, by pointer or key; letting go takes it back.
  #bindHoldToStart(button) {
    const begin = (event) => {
      if (
        button.disabled ||
        this.holding ||
        (event.type === "keydown" && (event.repeat || !["Enter", " "].includes(event.key)))
      )
        return;
      event.preventDefault();
      button.classList.add("holding");
      const { plan } = this.context.store.state;
      this.holding = setTimeout(() => {
        this.#cancelHold(button);
        if (plan.id === this.context.store.state.plan?.id) this.#start(plan); // else it is not what was looked at when it was pressed
      }, START_HOLD);
    };
    const end = () => this.#cancelHold(button);
    for (const name of ["pointerdown", "keydown"]) button.addEventListener(name, begin);
    for (const name of ["pointerup", "pointerleave", "pointercancel", "keyup", "blur"])
      button.addEventListener(name, end);
  }

  #cancelHold(button) {
    clearTimeout(this.holding);
    this.holding = null;
    button.classList.remove("holding");
  }

  #start(plan) {
    const { context, lease, parts } = this;
    context.attempt(async () => {
      await post("executions", { plan: plan.id, override: Number(parts.speed.value) / 100 }, lease.headers);
      await context.eventStream.read("executions");
    });
  }

  #sendCommand(verb) {
    const status = activeExecution(this.context.store.state);
    if (!status) return;
    const [word, body] = { back: ["step", { length: -STEP_LENGTH }], step: ["step", { length: STEP_LENGTH }] }[
      verb
    ] ?? [verb, {}];
    this.context.attempt(() => post(resourcePath("executions", status.execution, word), body, this.lease.headers));
  }

  // While the slider moves the newest wish is sent, one order at a time.
  async #sendOverride() {
    this.parts.share.textContent = formatPercent(Number(this.parts.speed.value) / 100);
    if (this.sending) {
      this.again = true;
      return;
    }
    this.sending = true;
    do {
      this.again = false;
      const status = activeExecution(this.context.store.state);
      const override = Number(this.parts.speed.value) / 100;
      if (status)
        await this.context.attempt(() =>
          post(resourcePath("executions", status.execution, "override"), { override }, this.lease.headers),
        );
    } while (this.again);
    this.sending = false;
  }

  #name() {
    const name = this.parts.name.value.trim() || "this page";
    localStorage.setItem("operator", name);
    return name;
  }

  #render(state) {
    const { parts, lease } = this;
    const busy = activeExecution(state);
    const status = busy ?? (state.executor?.execution ? state.executor : state.executions?.[0]?.status);
    const away = state.connection === "lost";
    patchChildren(parts.state, content(status, busy, away));
    parts.start.disabled = Boolean(busy) || !state.plan || away || (state.lease?.holder && !lease.held);
    parts.why.textContent = startBlocker(state, busy, lease);
    parts.why.hidden = parts.why.textContent === "";
    for (const button of parts.buttons.children) button.disabled = !busy || !isAvailable(button.dataset.verb, busy);
    patchChildren(parts.who, away ? "Who holds control is not known." : holder(state.lease, lease));
    parts.name.parentElement.hidden = lease.token !== "";
  }
}

// Why the arm cannot be started now, and what to do.
function startBlocker(state, busy, lease) {
  if (state.connection === "lost" || busy) return ""; // said above
  if (!state.plan) return "It starts with a certified motion only: plan one above.";
  return state.lease?.holder && !lease.held
    ? `${state.lease.holder} holds control: ask for it below.`
    : "Keep the button pressed until the bar is full.";
}

// What makes sense now: the arm is held before it steps, and runs before it is held. Stop does always, and
// reverse where there is a path: not with a live hand.
function isAvailable(verb, { state, stretch }) {
  if (verb === "hold") return state !== "held";
  if (isTeleoperated(stretch) && ["step", "back", "reverse"].includes(verb)) return false;
  return !["resume", "step", "back"].includes(verb) || state === "held";
}

// How the execution stands; what is held need not be on the path yet.
function stateText({ state, stretch }) {
  if (state === "held" && stretch) return stretch.startsWith("on ") ? `Held ${stretch}` : `Held while ${stretch}`;
  return state === "following" && isTeleoperated(stretch)
    ? "Following a live hand"
    : (STATE_LABELS[state] ?? capitalize(state));
}

const isTeleoperated = (stretch) => stretch.startsWith("mirroring");

function content(status, busy, away) {
  if (away)
    return [element("p", { class: "state" }, "Not known: the service does not answer. On a lost link the arm holds.")];
  if (!status)
    return [
      element(
        "p",
        { class: "state" },
        element("span", { class: "dot idle" }),
        "At rest. Nothing has been executed yet.",
      ),
    ];
  return [
    element(
      "p",
      { class: "state" },
      element("span", { class: `dot ${status.state}` }),
      stateText(status),
      status.reason && element("span", { class: "reason" }, `: ${status.reason}`),
    ),
    progressBar(status.progress, "progress along the path"),
    definitionList([
      ["Speed", formatPercent(status.override)],
      [busy ? "Time so far" : "Time taken", status.duration > 0 && formatNumber(status.duration, 1, "s")],
      ["Largest tracking error", status.tracking_error > 0 && formatNumber(status.tracking_error * 1000, 2, "mrad")],
      ["Largest limit use", status.limit_use > 0 && formatPercent(status.limit_use)],
      [
        "Setpoints late, missed",
        status.cycles > 0 &&
          `${formatNumber(status.late, 0)}, ${formatNumber(status.missed, 0)} of ${formatNumber(status.cycles, 0)}`,
      ],
    ]),
  ];
}

function holder(there, lease) {
  const order = (word, text) => element("button", { type: "button", "data-word": word, "data-key": word }, text);
  if (lease.waiting)
    return [`${there?.holder || "Somebody"} holds control and was asked for it. `, order("release", "Ask no more")];
  if (lease.held)
    return [
      "You hold control. ",
      there?.asking && `${there.asking} asks for it. `,
      there?.asking && order("keep", "Keep it"),
      order("release", "Give it back"),
    ];
  if (there?.holder) return [`${there.holder} holds control. `, order("ask", "Ask for it")];
  return ["Nobody holds control; every page may give orders. ", order("take", "Take control")];
}

function parts() {
  const order = (verb, text, title) => element("button", { type: "button", "data-verb": verb, title }, text);
  const state = element("div", { role: "status" });
  const start = element("button", { type: "button", class: "primary hold", disabled: "" }, "Hold to start the arm");
  const why = element("p", { class: "note" });
  const buttons = element(
    "p",
    { class: "buttons steer" },
    order("hold", "Hold"),
    order("resume", "Resume"),
    order("back", "− 1 cm", "Step back by a centimetre"),
    order("step", "+ 1 cm", "Step ahead by a centimetre"),
    order("reverse", "Reverse"),
    order("stop", "Stop"),
  );
  const speed = element("input", { type: "range", id: "speed", min: "0", max: "100", step: "1", value: "100" });
  const share = element("output", { for: "speed" }, formatPercent(1));
  const who = element("p", { class: "who" });
  const name = element("input", {
    type: "text",
    id: "operator",
    maxlength: "64",
    value: localStorage.getItem("operator") ?? "",
    placeholder: "shown to everybody",
    autocomplete: "off",
  });
  return {
    all: [
      state,
      element("p", { class: "buttons" }, start),
      why,
      buttons,
      element("p", { class: "field" }, element("label", { for: "speed" }, "Speed"), speed, share),
      who,
      element("p", { class: "field" }, element("label", { for: "operator" }, "Your name"), name),
    ],
    state,
    start,
    why,
    buttons,
    speed,
    share,
    who,
    name,
  };
}
