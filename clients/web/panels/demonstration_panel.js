// Demonstrations without a glove: by mouse, touch, keyboard, gamepad or headset, one after the other.
import { get, patch, put, resourcePath } from "../api.js";
import { capitalize, definitionList, element, formatNumber, hint, pluralize } from "../elements.js";
import { DemonstrationSession } from "../hand/demonstration_session.js";
import { SAMPLE_RATE } from "../hand/fixed_rate_timer.js";
import { XrHand, xrUnavailableReason } from "../hand/xr_hand.js";
import { isName, nameRefusal } from "../names.js";

const PHASE_TEXTS = {
  countdown: "Get ready …",
  ready: "Press on the box, carry it to its goal and let go.",
  carrying: "Carrying. Let go at the goal.",
  judging: "Let go. Waiting for the recorder …",
  returning: "The box goes back to its start.",
  lost: "The connection broke off; what was carried is lost. Connecting again …",
};
const HELP = [
  ["Mouse", "press and drag; shift or the wheel changes the height"],
  ["Touch", "one finger drags, a second one changes the height"],
  ["Keyboard", "Enter grasps and lets go; arrows, Page Up, Page Down"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
];

export function demonstrationPanel(place, context) {
  const panel = new DemonstrationPanel(place, context);
  return {
    update: (state, changed) => panel.update(state, changed),
    headset: () => panel.hand,
    session: () => panel.session ?? null,
  };
}

class DemonstrationPanel {
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
    discard.addEventListener("click", () => this.#setDiscarded(true));
    undo.addEventListener("click", () => this.#setDiscarded(false));
    seconds.addEventListener("change", () => (this.seconds = Number(seconds.value)));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden && this.session && !this.hand)
        this.#stop("The page was hidden, so recording has stopped; what was carried is lost.", { discard: true });
    });
    addEventListener("pagehide", () => this.session?.sender.close());
    this.#checkHeadset();
    navigator.xr?.addEventListener?.("devicechange", () => this.#checkHeadset());
  }

  update(state, changed) {
    if (changed.has("task") && this.session && state.task !== this.session.task) this.#stop("");
    if (changed.has("tasks") || changed.has("task")) this.#render();
  }

  async #checkHeadset() {
    this.why = await xrUnavailableReason();
    this.#render();
  }

  async #begin({ headset = false } = {}) {
    if (this.session || this.#beginning) return;
    this.#beginning = true;
    const { context, parts } = this;
    // The headset's session first: it must come from the click itself.
    const hand = headset && (await context.attempt(() => this.#startHeadset()));
    const session = (hand || !headset) && (await context.attempt(() => this.#record(headset ? 0 : SAMPLE_RATE)));
    this.#beginning = false;
    if (!session) {
      await this.#stop("");
      return;
    }
    this.#hideServiceObject(true);
    this.#render();
    parts.finish.focus();
    for (let left = this.seconds; left > 0 && this.session === session; left--) {
      this.#setStatusText(`Get ready: ${left}`);
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
    if (this.session !== session) return;
    await context.attempt(() => session.startRecording());
    if (!hand) context.overlay.element.focus({ preventScroll: true });
  }

  // Begin a recording for the task that is chosen now; null when another one was chosen before it began.
  async #record(rate) {
    const { context } = this;
    const { task, scene } = await this.#scene();
    if (task !== context.store.state.task) return null;
    const session = new DemonstrationSession(context, scene, task, {
      onChange: () => this.#render(),
      onError: (why) => this.#stop(why),
    });
    this.session = session;
    try {
      await session.begin({ rate });
    } catch (error) {
      if (this.session === session) throw error;
    }
    return this.session === session ? session : null;
  }

  // The chosen task and its scene; without any task one is made.
  async #scene() {
    const { store, eventStream } = this.context;
    if (!store.state.task) {
      const name = this.parts.name.value.trim() || "first-task";
      if (!isName(name)) throw new Error(nameRefusal("task", name));
      await put(resourcePath("tasks", name), { scene: "paper" });
      store.set({ task: store.state.task || name });
      await eventStream.read("tasks");
    }
    const { task } = store.state;
    const [{ scene }, scenes] = await Promise.all([get(resourcePath("tasks", task)), get("scenes")]);
    return { task, scene: scenes.find(({ name }) => name === scene) };
  }

  async #startHeadset() {
    const hand = new XrHand(this.context.view.viewer, {
      onSample: (sample) => {
        if (this.session?.sender.live) this.session.setHeadsetSample(sample);
        hand.rig.busy = this.session?.mayBeRecorded(sample) ?? false;
        hand.rig.setText(this.#statusText());
      },
      onEnd: () => {
        this.hand = null;
        this.context.view.setFrameInterval(0);
        this.session?.setHeadsetSample(null);
        this.#render();
      },
      onError: (why) => this.#stop(why),
    });
    await hand.start();
    this.context.view.setFrameInterval(Infinity); // nobody looks at the page meanwhile
    this.hand = hand;
    return hand;
  }

  async #finish() {
    const report = await this.#stop("");
    if (!report) return;
    const { received, lost, refused, demonstrations } = report;
    const shown = demonstrations.length;
    const further = shown ? "" : " Grasp the box, carry it to its goal and let go; each time makes one demonstration.";
    this.context.messages.show(
      `Recorded ${shown} ${pluralize(shown, "demonstration")} from ${formatNumber(received, 0)} samples: ${lost} lost, ${refused} refused.${further}`,
    );
  }

  async #stop(why, { discard = false } = {}) {
    const { session, hand } = this;
    this.session = this.hand = null;
    if (session) this.#hideServiceObject(false);
    await hand?.end();
    if (!session) return null;
    const report = await session.finish({ discard }).catch((error) => {
      why ||= error.message;
      return null;
    });
    if (why) this.context.messages.show(why, "error");
    this.#render();
    return report;
  }

  // Discard the newest demonstration that is kept, or restore the one that was discarded last.
  async #setDiscarded(discarded) {
    const { demonstrations = [] } = this.session ?? {};
    const last = demonstrations.findLast((one) => Boolean(one.discarded_ns) !== discarded);
    if (!last) return;
    const amended = await this.context.attempt(() => patch(resourcePath("demonstrations", last.id), { discarded }));
    if (amended && this.session)
      this.session.demonstrations = this.session.demonstrations.map((one) => (one.id === amended.id ? amended : one));
    this.#render();
  }

  // While the page draws the carried object itself, the service's is not shown.
  #hideServiceObject(hidden) {
    const { viewer } = this.context.view;
    const node = viewer.scene_tree.children.object;
    if (node) node.object.visible = !hidden;
    this.context.overlay.setKeyboardLabel(
      hidden ? "Carry the box: Enter grasps and lets go, arrows move, Page Up and Page Down change the height" : "",
    );
    viewer.set_dirty();
  }

  #statusText() {
    const { session } = this;
    if (!session) return "";
    const last = session.demonstrations.at(-1);
    const before = session.note || (last && `Take ${last.number}: ${last.verdict}.`) || "";
    const wrong = session.phase === "carrying" && session.handModel.collidingObstacle(session.handModel.position);
    if (wrong) return `The box is in the ${wrong}.`;
    return session.phase === "carrying" ? PHASE_TEXTS.carrying : `${before} ${PHASE_TEXTS[session.phase]}`.trim();
  }

  #setStatusText(text) {
    this.parts.statusText.textContent = text;
  }

  #render() {
    const { parts, session, context } = this;
    const { task, tasks } = context.store.state;
    document.documentElement.dataset.session = session?.phase ?? "";
    parts.idle.hidden = Boolean(session);
    parts.active.hidden = !session;
    parts.named.hidden = Boolean(task) || tasks === null;
    parts.headset.disabled = this.why !== "";
    parts.why.textContent = this.why ?? "";
    if (!session) return;
    if (session.phase !== "countdown") this.#setStatusText(this.#statusText());
    parts.demonstrations.replaceChildren(...session.demonstrations.map(demonstrationRow));
    parts.discard.disabled = !session.demonstrations.some((one) => !one.discarded_ns);
    parts.undo.disabled = !session.demonstrations.some((one) => one.discarded_ns);
    const { offset, dropped, sequence } = session.sender;
    const figures = [
      ["Samples sent", formatNumber(sequence - dropped, 0)],
      ["Left out", dropped > 0 && formatNumber(dropped, 0)],
      ["Clock", offset && `${formatNumber(offset.ms, 1, "ms")} off, ± ${formatNumber(offset.within, 1, "ms")}`],
    ];
    parts.figures.replaceChildren(definitionList(figures));
  }
}

function parts() {
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  const start = button("Show it here", { class: "primary" });
  const headset = button("In a headset", { disabled: true });
  const why = element("p", { class: "note" });
  const name = element("input", { type: "text", id: "task-name", value: "first-task", autocomplete: "off" });
  const named = element("p", { class: "field" }, element("label", { for: "task-name" }, "Name of the task"), name);
  const options = [0, 3, 5].map((value) =>
    element("option", { value: String(value), selected: value === 3 ? "" : false }, value ? `${value} s` : "none"),
  );
  const seconds = element("select", { id: "countdown" }, options);
  const how = element("details", {}, element("summary", {}, "How to carry the box"), definitionList(HELP));
  const idle = element(
    "div",
    {},
    hint("No glove? Carry the box in the view yourself; the recorder takes it like any tracker."),
    named,
    element("p", { class: "field" }, element("label", { for: "countdown" }, "Countdown"), seconds),
    element("p", { class: "buttons" }, start, headset),
    why,
  );
  const statusText = element("p", { class: "session-status", role: "status" });
  const demonstrations = element("ol", { class: "demonstration-list", "aria-label": "demonstrations of this session" });
  const [discard, undo, finish] = [button("Discard the take"), button("Undo"), button("Finish", { class: "primary" })];
  const figures = element("div", {});
  const active = element(
    "div",
    { hidden: "" },
    statusText,
    demonstrations,
    element("p", { class: "buttons" }, finish, discard, undo),
    figures,
  );
  return {
    all: [idle, active, how],
    idle,
    active,
    start,
    headset,
    why,
    name,
    named,
    seconds,
    statusText,
    demonstrations,
    discard,
    undo,
    finish,
    figures,
  };
}

function demonstrationRow(demonstration) {
  const { received = 0, lost = 0 } = demonstration.account ?? {};
  const word = demonstration.discarded_ns ? "discarded" : demonstration.verdict;
  return element(
    "li",
    { class: word, value: String(demonstration.number) },
    element("span", { class: "number" }, String(demonstration.number)),
    element("span", { class: "verdict" }, word),
    element(
      "span",
      { class: "figure" },
      `${formatNumber(demonstration.duration, 1, "s")}, ${lost} of ${formatNumber(received + lost, 0)} lost`,
    ),
    demonstration.reasons?.length > 0 &&
      element("span", { class: "why" }, capitalize(demonstration.reasons.join("; "))),
  );
}
