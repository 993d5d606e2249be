// Show it here: demonstrations without a glove, by mouse, touch, keyboard, gamepad or headset, take after take.
import { at, get, patch, put } from "../api.js";
import { element, facts, hint, number, plural, sentence } from "../elements.js";
import { Showing } from "../hand/demonstration_session.js";
import { RATE } from "../hand/fixed_rate_timer.js";
import { HeadsetHand, unavailable } from "../hand/xr_hand.js";

const PHASES = {
  countdown: "Get ready …",
  ready: "Press on the box, carry it to its goal and let go.",
  carrying: "Carrying. Let go at the goal.",
  judging: "Let go. Waiting for the recorder …",
  returning: "The box goes back to its start.",
  lost: "The connection broke off; what was carried is lost. Connecting again …",
};
const HOW = [
  ["Mouse", "press and drag; shift or the wheel changes the height"],
  ["Touch", "one finger drags, a second one changes the height"],
  ["Keyboard", "Enter grasps and lets go; arrows, Page Up, Page Down"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
];

export function show(place, context) {
  const panel = new ShowPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), headset: () => panel.hand };
}

class ShowPanel {
  #beginning = false;

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.seconds = 3;
    this.parts = parts();
    place.append(...this.parts.all);
    const { start, headset, finish, discard, undo, seconds } = this.parts;
    start.addEventListener("click", () => this.#begin());
    headset.addEventListener("click", () => this.#begin({ headset: true }));
    finish.addEventListener("click", () => this.#finish());
    discard.addEventListener("click", () => this.#amend(true));
    undo.addEventListener("click", () => this.#amend(false));
    seconds.addEventListener("change", () => (this.seconds = Number(seconds.value)));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden && this.showing && !this.hand) this.#stop("The page was hidden, so recording has stopped; what was carried is lost.", { discard: true });
    });
    addEventListener("pagehide", () => this.showing?.link.close());
    this.#headsets();
    navigator.xr?.addEventListener?.("devicechange", () => this.#headsets());
  }

  update(state, changed) {
    if (changed.has("task") && this.showing && state.task !== this.showing.task) this.#stop("");
    if (changed.has("tasks") || changed.has("task")) this.#paint();
  }

  async #headsets() {
    this.why = await unavailable();
    this.#paint();
  }

  async #begin({ headset = false } = {}) {
    if (this.showing || this.#beginning) return;
    this.#beginning = true;
    const { context, parts } = this;
    // The headset's session first: it must come from the click itself.
    const hand = headset && (await context.attempt(() => this.#wear()));
    const showing = (hand || !headset) && (await context.attempt(() => this.#record(headset ? 0 : RATE)));
    this.#beginning = false;
    if (!showing) {
      await this.#stop("");
      return;
    }
    this.#hide(true);
    this.#paint();
    parts.finish.focus();
    for (let left = this.seconds; left > 0 && this.showing === showing; left--) {
      this.#say(`Get ready: ${left}`);
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
    if (this.showing !== showing) return;
    await context.attempt(() => showing.open());
    if (!hand) context.easel.element.focus({ preventScroll: true });
  }

  // Begin a recording for the task that is chosen now; null when another one was chosen before it began.
  async #record(rate) {
    const { context } = this;
    const { task, scene } = await this.#scene();
    if (task !== context.store.state.task) return null;
    const showing = new Showing(context, scene, task, { changed: () => this.#paint(), failed: (why) => this.#stop(why) });
    this.showing = showing;
    try {
      await showing.begin({ rate });
    } catch (error) {
      if (this.showing === showing) throw error;
    }
    return this.showing === showing ? showing : null;
  }

  // The chosen task and its scene; without any task one is made.
  async #scene() {
    const { store, feed } = this.context;
    if (!store.state.task) {
      const name = this.parts.name.value.trim() || "first-task";
      await put(at("tasks", name), { scene: "paper" });
      store.set({ task: store.state.task || name });
      await feed.read("tasks");
    }
    const { task } = store.state;
    const [{ scene }, scenes] = await Promise.all([get(at("tasks", task)), get("scenes")]);
    return { task, scene: scenes.find(({ name }) => name === scene) };
  }

  async #wear() {
    const hand = new HeadsetHand(this.context.view.viewer, {
      hear: (sample) => {
        if (this.showing?.link.live) this.showing.follow(sample);
        hand.rig.busy = this.showing?.isTaking(sample) ?? false;
        hand.rig.say(this.#sentence());
      },
      ended: () => {
        this.hand = null;
        this.context.view.spare(0);
        this.showing?.follow(null);
        this.#paint();
      },
      failed: (why) => this.#stop(why),
    });
    await hand.start();
    this.context.view.spare(Infinity); // nobody looks at the page meanwhile
    this.hand = hand;
    return hand;
  }

  async #finish() {
    const report = await this.#stop("");
    if (!report) return;
    const { received, lost, refused, demonstrations } = report;
    const shown = demonstrations.length;
    const further = shown ? "" : " Grasp the box, carry it to its goal and let go; each time makes one demonstration.";
    this.context.messages.say(`Recorded ${shown} ${plural(shown, "demonstration")} from ${number(received, 0)} samples: ${lost} lost, ${refused} refused.${further}`);
  }

  async #stop(why, { discard = false } = {}) {
    const { showing, hand } = this;
    this.showing = this.hand = null;
    if (showing) this.#hide(false);
    await hand?.end();
    if (!showing) return null;
    const report = await showing.finish({ discard }).catch((error) => {
      why ||= error.message;
      return null;
    });
    if (why) this.context.messages.say(why, "error");
    this.#paint();
    return report;
  }

  // Discard the newest take that is kept, or bring back the one that was discarded last.
  async #amend(discarded) {
    const takes = this.showing?.takes ?? [];
    const take = takes.findLast((one) => Boolean(one.discarded_ns) !== discarded);
    if (!take) return;
    const amended = await this.context.attempt(() => patch(at("demonstrations", take.id), { discarded }));
    if (amended && this.showing) this.showing.takes = this.showing.takes.map((one) => (one.id === amended.id ? amended : one));
    this.#paint();
  }

  // While the page carries the object itself, the station's own is not shown.
  #hide(hidden) {
    const { viewer } = this.context.view;
    const node = viewer.scene_tree.children.object;
    if (node) node.object.visible = !hidden;
    this.context.easel.keys(hidden ? "Carry the box: Enter grasps and lets go, arrows move, Page Up and Page Down change the height" : "");
    viewer.set_dirty();
  }

  #sentence() {
    const { showing } = this;
    if (!showing) return "";
    const last = showing.takes.at(-1);
    const before = showing.remark || (last && `Take ${last.number}: ${last.verdict}.`) || "";
    const wrong = showing.phase === "carrying" && showing.carry.touches(showing.carry.position);
    if (wrong) return `The box is in the ${wrong}.`;
    return showing.phase === "carrying" ? PHASES.carrying : `${before} ${PHASES[showing.phase]}`.trim();
  }

  #say(text) {
    this.parts.says.textContent = text;
  }

  #paint() {
    const { parts, showing, context } = this;
    const { task, tasks } = context.store.state;
    document.documentElement.dataset.showing = showing?.phase ?? "";
    parts.idle.hidden = Boolean(showing);
    parts.active.hidden = !showing;
    parts.named.hidden = Boolean(task) || tasks === null;
    parts.headset.disabled = this.why !== "";
    parts.why.textContent = this.why ?? "";
    if (!showing) return;
    if (showing.phase !== "countdown") this.#say(this.#sentence());
    parts.takes.replaceChildren(...showing.takes.map(line));
    parts.discard.disabled = !showing.takes.some((take) => !take.discarded_ns);
    parts.undo.disabled = !showing.takes.some((take) => take.discarded_ns);
    const { offset, leftOut, sequence } = showing.link;
    const figures = [
      ["Samples sent", number(sequence - leftOut, 0)],
      ["Left out", leftOut > 0 && number(leftOut, 0)],
      ["Clock", offset && `${number(offset.ms, 1, "ms")} off, ± ${number(offset.within, 1, "ms")}`],
    ];
    parts.figures.replaceChildren(facts(figures));
  }
}

function parts() {
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  const start = button("Show it here", { class: "primary" });
  const headset = button("In a headset", { disabled: true });
  const why = element("p", { class: "note" });
  const name = element("input", { type: "text", id: "task-name", value: "first-task", maxlength: "64", autocomplete: "off" });
  const named = element("p", { class: "field" }, element("label", { for: "task-name" }, "Name of the task"), name);
  const options = [0, 3, 5].map((value) => element("option", { value: String(value), selected: value === 3 ? "" : false }, value ? `${value} s` : "none"));
  const seconds = element("select", { id: "countdown" }, options);
  const how = element("details", {}, element("summary", {}, "How to carry the box"), facts(HOW));
  const idle = element(
    "div",
    {},
    hint("No glove? Carry the box in the view yourself; the recorder takes it like any tracker."),
    named,
    element("p", { class: "field" }, element("label", { for: "countdown" }, "Countdown"), seconds),
    element("p", { class: "orders" }, start, headset),
    why,
  );
  const says = element("p", { class: "says", role: "status" });
  const takes = element("ol", { class: "takes", "aria-label": "takes of this sitting" });
  const [discard, undo, finish] = [button("Discard the take"), button("Undo"), button("Finish", { class: "primary" })];
  const figures = element("div", {});
  const active = element("div", { hidden: "" }, says, takes, element("p", { class: "orders" }, finish, discard, undo), figures);
  return { all: [idle, active, how], idle, active, start, headset, why, name, named, seconds, says, takes, discard, undo, finish, figures };
}

function line(take) {
  const { received = 0, lost = 0 } = take.account ?? {};
  const word = take.discarded_ns ? "discarded" : take.verdict;
  return element(
    "li",
    { class: word, value: String(take.number) },
    element("span", { class: "number" }, String(take.number)),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, `${number(take.duration, 1, "s")}, ${lost} of ${number(received + lost, 0)} lost`),
    take.reasons?.length > 0 && element("span", { class: "why" }, sentence(take.reasons.join("; "))),
  );
}
