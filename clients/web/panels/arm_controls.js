// The arm: its state in words, a start that has to be meant, hold, resume, step, reverse, the speed; who holds control.
import { at, get, post } from "../api.js";
import { lease } from "../arm/lease.js";
import { bar, element, facts, number, percent, replace, sentence } from "../elements.js";
import { moving } from "../store.js";

const HOLD = 800; // [ms] that the start must be held
const LOOK = 2000; // [ms]
const STEP = 0.01; // [m]
export const WORDS = {
  idle: "At rest",
  starting: "Starting",
  approaching: "On the way to the path",
  following: "On the path",
  held: "Held on the path",
  stopping: "Coming to rest",
  ended: "Ended",
  faulted: "Given up",
};

export function control(place, context) {
  const panel = new ControlPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), show: () => panel.show(), hide: () => panel.hide() };
}

class ControlPanel {
  #asked = 0; // questions who holds control
  #answered = 0; // the newest of them that was answered

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.lease = lease;
    lease.changed = () => this.#look();
    this.parts = parts();
    place.append(...this.parts.all);
    this.parts.buttons.addEventListener("click", (event) => {
      const verb = event.target.closest("button[data-verb]")?.dataset.verb;
      if (verb) this.#steer(verb);
    });
    this.parts.who.addEventListener("click", (event) => {
      const word = event.target.closest("button[data-word]")?.dataset.word;
      if (word) context.attempt(() => this.lease[word](this.#name()));
    });
    this.parts.speed.addEventListener("input", () => this.#slow());
    this.#deliberate(this.parts.start);
  }

  show() {
    this.looking = setInterval(() => document.hidden || this.#look(), LOOK);
    this.#look();
  }

  hide() {
    clearInterval(this.looking);
  }

  update(state, changed) {
    if (["executor", "executions", "plan", "lease", "connection"].some((name) => changed.has(name))) this.#paint(state);
  }

  // Who holds control: the executor alone knows. An answer that comes behind that of a later question is too old.
  async #look() {
    const question = ++this.#asked;
    const lease = await get("lease").catch(() => null);
    if (question < this.#answered) return;
    this.#answered = question;
    this.context.store.set({ lease });
    this.#paint(this.context.store.state);
  }

  // The start begins only when the button has been held for a while, by pointer or key; letting go takes it back.
  #deliberate(button) {
    const begin = (event) => {
      if (button.disabled || this.holding || (event.type === "keydown" && (event.repeat || !["Enter", " "].includes(event.key)))) return;
      event.preventDefault();
      button.classList.add("holding");
      const { plan } = this.context.store.state;
      this.holding = setTimeout(() => {
        this.#let(button);
        if (plan.id === this.context.store.state.plan?.id) this.#start(plan); // else it is not what was looked at when it was pressed
      }, HOLD);
    };
    const end = () => this.#let(button);
    for (const name of ["pointerdown", "keydown"]) button.addEventListener(name, begin);
    for (const name of ["pointerup", "pointerleave", "pointercancel", "keyup", "blur"]) button.addEventListener(name, end);
  }

  #let(button) {
    clearTimeout(this.holding);
    this.holding = null;
    button.classList.remove("holding");
  }

  #start(plan) {
    const { context, lease, parts } = this;
    context.attempt(async () => {
      await post("executions", { plan: plan.id, override: Number(parts.speed.value) / 100 }, lease.headers);
      await context.feed.read("executions");
    });
  }

  #steer(verb) {
    const status = moving(this.context.store.state);
    if (!status) return;
    const [word, body] = { back: ["step", { length: -STEP }], step: ["step", { length: STEP }] }[verb] ?? [verb, {}];
    this.context.attempt(() => post(at("executions", status.execution, word), body, this.lease.headers));
  }

  // While the slider moves the newest wish is sent, one order at a time.
  async #slow() {
    this.parts.share.textContent = percent(Number(this.parts.speed.value) / 100);
    if (this.sending) {
      this.again = true;
      return;
    }
    this.sending = true;
    do {
      this.again = false;
      const status = moving(this.context.store.state);
      const override = Number(this.parts.speed.value) / 100;
      if (status) await this.context.attempt(() => post(at("executions", status.execution, "override"), { override }, this.lease.headers));
    } while (this.again);
    this.sending = false;
  }

  #name() {
    const name = this.parts.name.value.trim() || "this page";
    localStorage.setItem("operator", name);
    return name;
  }

  #paint(state) {
    const { parts, lease } = this;
    const busy = moving(state);
    const status = busy ?? (state.executor?.execution ? state.executor : state.executions?.[0]?.status);
    const away = state.connection === "lost";
    replace(parts.state, content(status, busy, away));
    parts.start.disabled = Boolean(busy) || !state.plan || away || (state.lease?.holder && !lease.held);
    parts.why.textContent = hindrance(state, busy, lease);
    parts.why.hidden = parts.why.textContent === "";
    for (const button of parts.buttons.children) button.disabled = !busy || !possible(button.dataset.verb, busy);
    replace(parts.who, away ? "Who holds control is not known." : holder(state.lease, lease));
    parts.name.parentElement.hidden = lease.token !== "";
  }
}

// Why the arm cannot be started now, and what to do.
function hindrance(state, busy, lease) {
  if (state.connection === "lost" || busy) return ""; // said above
  if (!state.plan) return "It starts with a certified motion only: plan one above.";
  return state.lease?.holder && !lease.held ? `${state.lease.holder} holds control: ask for it below.` : "Keep the button pressed until the bar is full.";
}

// What makes sense now: the arm is held before it steps, and runs before it is held. Stop does always, and
// reverse where there is a path: not with a live hand.
function possible(verb, { state, stretch }) {
  if (verb === "hold") return state !== "held";
  if (isLed(stretch) && ["step", "back", "reverse"].includes(verb)) return false;
  return !["resume", "step", "back"].includes(verb) || state === "held";
}

// How the execution stands; what is held need not be on the path yet.
function worded({ state, stretch }) {
  if (state === "held" && stretch) return stretch.startsWith("on ") ? `Held ${stretch}` : `Held while ${stretch}`;
  return state === "following" && isLed(stretch) ? "Following a live hand" : (WORDS[state] ?? sentence(state));
}

const isLed = (stretch) => stretch.startsWith("mirroring");

function content(status, busy, away) {
  if (away) return [element("p", { class: "state" }, "Not known: the service does not answer. On a lost link the arm holds.")];
  if (!status) return [element("p", { class: "state" }, element("span", { class: "dot idle" }), "At rest. Nothing has been executed yet.")];
  return [
    element("p", { class: "state" }, element("span", { class: `dot ${status.state}` }), worded(status), status.reason && element("span", { class: "reason" }, `: ${status.reason}`)),
    bar(status.progress, "progress along the path"),
    facts([
      ["Speed", percent(status.override)],
      [busy ? "Time so far" : "Time taken", status.duration > 0 && number(status.duration, 1, "s")],
      ["Largest tracking error", status.tracking_error > 0 && number(status.tracking_error * 1000, 2, "mrad")],
      ["Largest limit use", status.limit_use > 0 && percent(status.limit_use)],
      ["Setpoints late, missed", status.cycles > 0 && `${number(status.late, 0)}, ${number(status.missed, 0)} of ${number(status.cycles, 0)}`],
    ]),
  ];
}

function holder(there, lease) {
  const order = (word, text) => element("button", { type: "button", "data-word": word, "data-key": word }, text);
  if (lease.waiting) return [`${there?.holder || "Somebody"} holds control and was asked for it. `, order("release", "Ask no more")];
  if (lease.held) return ["You hold control. ", there?.asking && `${there.asking} asks for it. `, there?.asking && order("keep", "Keep it"), order("release", "Give it back")];
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
    { class: "orders steer" },
    order("hold", "Hold"),
    order("resume", "Resume"),
    order("back", "− 1 cm", "Step back by a centimetre"),
    order("step", "+ 1 cm", "Step ahead by a centimetre"),
    order("reverse", "Reverse"),
    order("stop", "Stop"),
  );
  const speed = element("input", { type: "range", id: "speed", min: "0", max: "100", step: "1", value: "100" });
  const share = element("output", { for: "speed" }, percent(1));
  const who = element("p", { class: "who" });
  const name = element("input", { type: "text", id: "operator", maxlength: "64", value: localStorage.getItem("operator") ?? "", placeholder: "shown to everybody", autocomplete: "off" });
  return {
    all: [
      state,
      element("p", { class: "orders" }, start),
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
