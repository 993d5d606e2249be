// An object that lies elsewhere: its place and its goal are dragged in the view or entered, the path follows, and the service
// saves and certifies the adapted version.
import { ApiError, get, post, put, resourcePath } from "../api.js";
import { block, element } from "../elements.js";
import { numberInput, readNumber } from "../number_input.js";
import { capitalize } from "../texts.js";
import { predictPath } from "./adaptation_model.js";
import { describeCertainty } from "./adaptation_range.js";
import { ENDS, TargetOverlay } from "./target_overlay.js";

/** @typedef {import("./target_overlay.js").End} End */

const AXES = ["x", "y", "z"];
const MAX_COORDINATE = 10; // [m] the service accepts no more
const HELP =
  "Drag the yellow ball to where the object lies and the green one to where it is to go: they move on their level. The path follows.";
const UNSAVED_SENTENCE = "Save the version first; only what is saved is adapted.";

/** @param {HTMLElement} place @param {Editor} editor @returns {EditorSection} */
export function adaptationSection(place, editor) {
  const section = new AdaptationSection(place, editor);
  return { update: (_, what) => section.update(what) };
}

class AdaptationSection {
  /** @type {AdaptationModel | null} */
  #model = null; // of the version that is adapted; null: off
  /** @type {Record<End, Point>} */
  #ends = { start: [0, 0, 0], goal: [0, 0, 0] };
  /** @type {{end: End, from: Point} | null} */
  #drag = null; // the ball, and where under it the pointer took it
  #frame = 0;
  #note = "";
  #requests = 0;

  /** @param {HTMLElement} place @param {Editor} editor */
  constructor(place, editor) {
    this.editor = editor;
    this.overlay = editor.overlay;
    this.targets = new TargetOverlay(editor.overlay, editor.curveOverlay.group);
    this.toggle = element("button", { type: "button", id: "edit-adapt" }, "Move object and goal");
    this.certify = element(
      "button",
      { type: "button", id: "edit-adapt-certify", class: "primary" },
      "Adapt and certify",
    );
    this.status = element("p", { class: "note", id: "edit-adapted", role: "status" });
    this.inputs = { start: this.#fields("start"), goal: this.#fields("goal") };
    this.details = element(
      "div",
      { hidden: "" },
      this.#row("Object (mm)", "start"),
      this.#row("Goal (mm)", "goal"),
      element("div", { class: "row" }, this.certify),
    );
    place.append(element("div", { class: "row choice" }, this.toggle), this.status, this.details);
    this.toggle.addEventListener("click", () => editor.context.attempt(() => this.#set(!this.#model)));
    this.certify.addEventListener("click", () => editor.context.attempt(() => this.#adapt()));
    this.overlay.capturePointer({
      down: (event) => this.#down(event),
      move: (event) => this.#move(event),
      up: () => this.#up(),
    });
  }

  /** @param {EditorChange} what */
  update(what) {
    const { draft, active } = this.editor;
    if (what === "draft") {
      this.#note = "";
      if (this.#model) this.editor.context.attempt(() => this.#set(active));
    }
    if (what === "curve" || what === "draft") {
      block(this.certify, draft && !draft.edited ? "" : "Save the version first; a saved version is adapted.");
      this.#say();
    }
  }

  /** @param {boolean} on */
  async #set(on) {
    const request = ++this.#requests;
    const { draft } = this.editor;
    /** @type {AdaptationModel | null} */
    const model =
      on && draft
        ? await get(resourcePath("paths", draft.path, "versions", draft.base.number, "adaptation-model"))
        : null;
    if (request !== this.#requests) return; // switched again meanwhile
    this.#model = model;
    this.toggle.setAttribute("aria-pressed", String(model !== null));
    this.details.hidden = model === null;
    if (model) {
      this.#ends = { start: model.version[0], goal: model.version[model.version.length - 1] };
      this.#redraw();
    } else {
      this.targets.hide();
      this.#say();
    }
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (!this.#model || !this.editor.active || event.button !== 0 || this.#drag) return false;
    const end = this.targets.pick(this.#ends, [event.clientX, event.clientY]);
    const from = end && this.#onLevel(event, this.#ends[end]);
    if (!end || !from) return false;
    this.#note = "";
    this.#drag = { end, from: from.map((value, axis) => value - this.#ends[end][axis]) };
    return true;
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const drag = this.#drag;
    if (!drag) return;
    const at = this.#onLevel(
      event,
      this.#ends[drag.end].map((value, axis) => value + drag.from[axis]),
    );
    if (!at) return;
    this.#ends[drag.end] = at.map((value, axis) => clamp(value - drag.from[axis]));
    this.#frame ||= requestAnimationFrame(() => this.#redraw());
  }

  #up() {
    if (this.#drag) this.#redraw();
    this.#drag = null;
  }

  /** Where the pointer is on the level of a point: objects are moved on their table. @param {PointerEvent} event @param {Point} through */
  #onLevel(event, through) {
    return this.overlay.unproject(event.clientX, event.clientY, { through, normal: [0, 0, 1] });
  }

  #redraw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    const model = this.#model;
    if (!model) return;
    const { start, goal } = this.#ends;
    this.editor.timings.measureFrame(() => {
      const { points, deviation } = predictPath(model, start, goal);
      this.targets.draw(points);
      this.#say(describeCertainty(model, start, goal, deviation));
      for (const end of ENDS) {
        for (const [axis, input] of this.inputs[end].entries()) {
          if (input !== document.activeElement) input.value = (1000 * this.#ends[end][axis]).toFixed(1);
        }
      }
    }, this.editor.context.view);
  }

  /** @param {string} [certainty] of the path as it is dragged */
  #say(certainty) {
    if (!this.#model) this.status.textContent = HELP;
    else if (this.editor.draft?.edited) this.status.textContent = UNSAVED_SENTENCE;
    else if (this.#note) this.status.textContent = this.#note;
    else if (certainty !== undefined) this.status.textContent = certainty;
  }

  async #adapt() {
    const { draft, context } = this.editor;
    if (!draft || !this.#model) return;
    const { start, goal } = this.#ends;
    await this.#reportObject(start);
    const wanted = { version: draft.base.number, start: { position: start }, goal: { position: goal } };
    /** @type {Adaptation} */
    const { version, note, job } = await post(resourcePath("paths", draft.path, "adaptations"), wanted);
    context.messages.show(`${capitalize(note)}.`);
    await this.editor.loadVersion(version.number, draft);
    this.#note = `${capitalize(note)}.`;
    this.editor.followPlanning({ ...job, path: draft.path, version });
    this.#say();
  }

  /** Say where the object lies, in a scene that has one: else the plan would not start. @param {Point} position */
  async #reportObject(position) {
    const { task, tasks } = this.editor.context.store.state;
    const scene = tasks?.find(({ name }) => name === task)?.scene;
    if (!scene) return;
    const object = resourcePath("scenes", scene, "object");
    try {
      const { orientation } = await get(object);
      await put(object, { position, orientation });
    } catch (error) {
      if (!(error instanceof ApiError && error.status === 404)) throw error; // a scene without an object
    }
  }

  /** @param {End} end */
  #fields(end) {
    return AXES.map((name, axis) => {
      const label = `${name} of ${end === "start" ? "the object" : "the goal"} in millimetres`;
      const limits = { min: -1000 * MAX_COORDINATE, max: 1000 * MAX_COORDINATE, unit: "mm" };
      const input = numberInput({ id: `edit-${end}-${name}`, "aria-label": label, ...limits });
      input.addEventListener("change", () => {
        const { value, fault } = readNumber(input);
        if (value === undefined) {
          this.editor.context.messages.show(`The ${label} ${input.value || "is empty; it"} ${fault}.`, "error");
        } else {
          this.#note = "";
          this.#ends[end] = this.#ends[end].map((old, i) => (i === axis ? value / 1000 : old));
          this.#redraw();
        }
        input.value = (1000 * this.#ends[end][axis]).toFixed(1);
      });
      return input;
    });
  }

  /** @param {string} title @param {End} end */
  #row(title, end) {
    return element("div", { class: "fields" }, element("span", {}, title), this.inputs[end]);
  }
}

/** @param {number} value [m] */
const clamp = (value) => Math.max(-MAX_COORDINATE, Math.min(MAX_COORDINATE, value));
