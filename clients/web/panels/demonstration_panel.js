// Demonstrations without a glove: by mouse, touch, keyboard, gamepad or headset, one after the other.
import { get, patch, put, resourcePath } from "../api.js";
import { displayNameOf, idOf } from "../display_names.js";
import { block, closestData } from "../elements.js";
import { DemonstrationSession } from "../hand/demonstration_session.js";
import { SAMPLE_RATE } from "../hand/fixed_rate_timer.js";
import { XrHand, xrUnavailableReason } from "../hand/xr_hand.js";
import { patchChildren } from "../patch_children.js";
import { changesAny } from "../store.js";
import { formatNumber, pluralize } from "../texts.js";
import { createElements, demonstrationRow, senderFacts, sessionText } from "./demonstration_elements.js";
import { countFresh, learn, learnButton } from "./learning.js";

const PAGE_HIDDEN_SENTENCE = "The page was hidden, so recording has stopped; what was carried is lost.";
const KEYS = "Carry the object: Enter grasps and lets go, arrows move, Page Up and Page Down change the height";
const NOTHING_SHOWN = "Grasp the object, carry it to its goal and let go; each time makes one demonstration.";

/** @param {HTMLElement} place @param {Context} context */
export function demonstrationPanel(place, context) {
  const panel = new DemonstrationPanel(place, context);
  return {
    /** @type {Section["update"]} */
    update: (state, changed) => panel.update(state, changed),
    headset: () => panel.headset,
    session: () => panel.session,
  };
}

class DemonstrationPanel {
  /** @type {XrHand | null} */
  headset = null; // that is worn now
  /** @type {DemonstrationSession | null} */
  session = null; // of the demonstration that is shown now
  #isBeginning = false;
  /** @type {string | null} */
  #headsetReason = null; // why there is none; null: not known yet

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.elements = createElements();
    place.append(...this.elements.all);
    const { start, headset, next, finish, discard, undo } = this.elements;
    start.addEventListener("click", () => this.#begin());
    headset.addEventListener("click", () => this.#begin({ withHeadset: true }));
    next.addEventListener("click", (event) => {
      if (closestData(event).learn) context.attempt(() => this.#learn());
    });
    finish.addEventListener("click", () => this.#finish());
    discard.addEventListener("click", () => this.#setDiscarded(true));
    undo.addEventListener("click", () => this.#setDiscarded(false));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden && this.session && !this.headset) this.#stop(PAGE_HIDDEN_SENTENCE, { discard: true });
    });
    addEventListener("pagehide", () => this.session?.sender.close());
    this.#checkHeadset();
    navigator.xr?.addEventListener?.("devicechange", () => this.#checkHeadset());
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (changed.has("task") && this.session && state.task !== this.session.task) this.#stop("");
    if (changesAny(changed, "tasks", "task")) this.#render();
    if (changesAny(changed, "demonstrations", "runs", "selectedRun", "jobs", "task")) this.#showNext(state);
  }

  /** Offer to learn what was shown since it was learned last. @param {State} state */
  #showNext(state) {
    const isKnown = state.runs?.length === 0 || state.selectedRun; // what was learned so far
    const count = isKnown ? countFresh(state) : 0;
    const words = `${count} ${pluralize(count, "demonstration")}`;
    patchChildren(this.elements.next, count > 0 && learnButton(state, `Learn the ways of ${words}`));
    this.elements.start.classList.toggle("primary", count === 0);
  }

  async #learn() {
    await learn(this.context.store.state);
    this.context.open("ways");
  }

  async #checkHeadset() {
    this.#headsetReason = await xrUnavailableReason();
    this.#render();
  }

  async #begin({ withHeadset = false } = {}) {
    if (this.session || this.#isBeginning) return;
    this.#isBeginning = true;
    const { context, elements } = this;
    // The headset's session first: it must come from the click itself.
    const isReady = !withHeadset || (await context.attempt(() => this.#startHeadset()));
    const session = isReady ? await context.attempt(() => this.#record(withHeadset ? 0 : SAMPLE_RATE)) : null;
    this.#isBeginning = false;
    if (!session) {
      await this.#stop("");
      return;
    }
    this.#hideServiceObject(true);
    this.#render();
    elements.finish.focus();
    const isCurrent = () => this.session === session;
    for (let left = Number(elements.seconds.value); left > 0 && isCurrent(); left--) {
      elements.statusText.textContent = `Get ready: ${left}`;
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
    if (!isCurrent()) return;
    await context.attempt(() => session.startRecording());
    if (!withHeadset) context.overlay.element.focus({ preventScroll: true });
  }

  /**
   * Begin a recording for the task that is chosen now; null when another one was chosen before it began.
   * @param {number} rate of the samples [Hz]
   */
  async #record(rate) {
    const { context } = this;
    const { task, scene } = await this.#taskAndScene();
    if (task !== context.store.state.task || !scene) return null;
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

  /** The chosen task and its scene; without any task one is made. */
  async #taskAndScene() {
    const { store, eventStream } = this.context;
    if (!store.state.task) {
      const called = this.elements.name.value.trim() || "first-task";
      const name = idOf(called);
      await put(resourcePath("tasks", name || called), { scene: "paper", display_name: displayNameOf(called) });
      store.set({ task: store.state.task || name });
      await eventStream.read("tasks");
    }
    const { task } = store.state;
    /** @type {[Task, Scene[]]} */
    const [{ scene }, scenes] = await Promise.all([get(resourcePath("tasks", task)), get("scenes")]);
    return { task, scene: scenes.find(({ name }) => name === scene) };
  }

  async #startHeadset() {
    const { view } = this.context;
    const headset = new XrHand(view.viewer, {
      onSample: (sample) => {
        const session = this.session;
        if (session?.sender.live) session.setHeadsetSample(sample);
        headset.rig.busy = session?.mayBeRecorded(sample) ?? false;
        headset.rig.setText(session ? sessionText(session) : "");
      },
      onEnd: () => {
        this.headset = null;
        view.setFrameInterval(0);
        this.session?.endHeadset();
        this.#render();
      },
      onError: (why) => this.#stop(why),
    });
    await headset.start();
    view.setFrameInterval(Infinity); // nobody looks at the page meanwhile
    this.headset = headset;
    return true;
  }

  async #finish() {
    const report = await this.#stop("");
    if (!report) return;
    const { received, lost, refused, demonstrations } = report;
    const shown = `Recorded ${demonstrations.length} ${pluralize(demonstrations.length, "demonstration")}`;
    const samples = `${formatNumber(received, 0)} samples: ${lost} lost, ${refused} refused.`;
    this.context.messages.show(`${shown} from ${samples}${demonstrations.length ? "" : ` ${NOTHING_SHOWN}`}`);
  }

  /**
   * End the session; returns its report, or null.
   * @param {string} why is shown as an error; "": nothing is
   * @param {{discard?: boolean}} options
   */
  async #stop(why, { discard = false } = {}) {
    const [session, headset] = [this.session, this.headset];
    this.session = this.headset = null;
    if (session) this.#hideServiceObject(false);
    await headset?.end();
    if (!session) return null;
    let sentence = why;
    const report = await session.finish({ discard }).catch((error) => {
      sentence ||= error.message;
      return null;
    });
    if (sentence) this.context.messages.show(sentence, "error");
    this.#render();
    return report;
  }

  /**
   * Discard the newest demonstration that is kept, or restore the one that was discarded last.
   * @param {boolean} discarded
   */
  async #setDiscarded(discarded) {
    const last = this.session?.demonstrations.findLast((one) => Boolean(one.discarded_ns) !== discarded);
    if (!last) return;
    const path = resourcePath("demonstrations", last.id);
    /** @type {Demonstration | undefined} */
    const amended = await this.context.attempt(() => patch(path, { discarded }));
    const session = this.session;
    if (amended && session) {
      session.demonstrations = session.demonstrations.map((one) => (one.id === amended.id ? amended : one));
    }
    this.#render();
  }

  /**
   * While the page draws the carried object itself, the service's is not shown.
   * @param {boolean} hidden
   */
  #hideServiceObject(hidden) {
    const { viewer } = this.context.view;
    const node = viewer.scene_tree.children.object;
    if (node) node.object.visible = !hidden;
    this.context.overlay.setKeyboardLabel(hidden ? KEYS : "");
    viewer.set_dirty();
  }

  #render() {
    const { elements, context } = this;
    const session = this.session;
    const { task, tasks } = context.store.state;
    document.documentElement.dataset.session = session?.phase ?? "";
    elements.idle.hidden = session !== null;
    elements.active.hidden = session === null;
    elements.nameField.hidden = Boolean(task) || tasks === null;
    if (this.#headsetReason !== null) block(elements.headset, this.#headsetReason);
    elements.why.textContent = this.#headsetReason ?? "";
    if (!session) return;
    if (session.phase !== "countdown") elements.statusText.textContent = sessionText(session);
    elements.demonstrations.replaceChildren(...session.demonstrations.map(demonstrationRow));
    const [isKept, isDiscarded] = [false, true].map((discarded) =>
      session.demonstrations.some((one) => Boolean(one.discarded_ns) === discarded),
    );
    block(elements.discard, isKept ? "" : "There is no take to discard.");
    block(elements.undo, isDiscarded ? "" : "No take was discarded.");
    elements.figures.replaceChildren(senderFacts(session.sender));
  }
}
