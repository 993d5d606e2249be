// The guided calibration in the tab Scene: touch places, see how far they contradict each other, try it, then keep it.
import { get, put, resourcePath } from "../api.js";
import { block, element } from "../elements.js";
import { missingSentence } from "../identity.js";
import { readNumber } from "../number_input.js";
import { refill } from "../panels/teleop_elements.js";
import { patchChildren } from "../patch_children.js";
import { capitalize } from "../texts.js";
import { ABOUT_AIM, calibrationParts, lengthText, MIN_POINTS, placeText } from "./calibration_parts.js";
import { distance, mapped, movedScene, placedByTouch, THREE_POINTS, topCorners } from "./placement.js";
import { ARM_TOOL, touch } from "./touch.js";

const UNKEPT = "scene"; // names what is only looked at
const GONE_SENTENCE = "and is gone: choose it again when it is back, or take those points back";
const MARK = "calibration"; // the cross in the view
const MARK_SIZE = 0.03; // [m]

/** @typedef {{seen: number[], place: number[]}} Pair where a place was seen, and where it is [m] */
/** @typedef {{scene: () => Scene | null, shape: () => Shape | null, changeShape: (shape: Shape, what: string) => void, changeScene: (scene: Scene, what: string) => void}} SceneEditor */

export class CalibrationGuide {
  /** @type {Pair[]} */
  #pairs = [];
  /** @type {MeasuredCalibration | null} */
  #fit = null; // of the pairs, as the service finds it
  #fault = "";
  #tried = "";
  #proposed = ""; // the corners that were proposed to be touched
  #with = ""; // what touched the pairs
  #isBusy = false;

  /** @param {HTMLElement} place @param {Context} context @param {SceneEditor} editor */
  constructor(place, context, editor) {
    this.context = context;
    this.editor = editor;
    this.parts = calibrationParts();
    const { all, aim, device, touched, again, trial, keep, name } = this.parts;
    place.append(...all);
    for (const select of [aim, device]) select.addEventListener("change", () => this.#restart());
    name.addEventListener("input", () => this.#render());
    touched.addEventListener("click", () => this.#order(() => this.#touch()));
    again.addEventListener("click", () => this.#order(() => this.#takeBack()));
    trial.addEventListener("click", () => this.#order(() => this.#try()));
    keep.addEventListener("click", () => this.#order(() => this.#keep()));
    this.#restart();
  }

  /** Show what can be touched with, and what is done. */
  show() {
    const corners = JSON.stringify(this.#corners());
    if (corners !== this.#proposed && !this.#pairs.length) this.#propose();
    this.#render();
  }

  /** Take the mark out of the view. */
  hide() {
    this.#mark(null);
  }

  /** Offer the calibrations that a shape may be touched under. */
  async readCalibrations() {
    /** @type {MeasuredCalibration[]} */
    const known = await get("calibrations");
    refill(
      this.parts.frame,
      known.map(({ calibration }) => calibration.name),
    );
  }

  get #aim() {
    return /** @type {import("./calibration_parts.js").Aim} */ (this.parts.aim.value);
  }

  #restart() {
    this.#pairs = [];
    this.#forget();
    this.#propose();
    this.#render();
  }

  /** What was found of former points holds no more. */
  #forget() {
    this.#fit = null;
    this.#fault = "";
    this.#tried = "";
    this.#mark(null);
  }

  /** Write the next corner of the table as the place to touch. */
  #propose() {
    const corners = this.#corners();
    this.#proposed = JSON.stringify(corners);
    const corner = corners[this.#pairs.length % corners.length];
    this.parts.place.forEach((input, k) => {
      input.value = corner ? String(Number((1000 * corner[k]).toFixed(1))) : "";
    });
  }

  /** The corners of the chosen box, else of the first that stands there: the table as a rule. */
  #corners() {
    const [chosen, scene] = [this.editor.shape(), this.editor.scene()];
    const box = chosen?.kind === "box" ? chosen : scene?.obstacles.find(({ kind }) => kind === "box");
    return box ? topCorners(box) : [];
  }

  /** @param {() => Promise<void>} order one at a time */
  async #order(order) {
    if (this.#isBusy) return;
    this.#isBusy = true;
    this.#render();
    await this.context.attempt(order);
    this.#isBusy = false;
    this.#render();
  }

  async #touch() {
    const [aim, place] = [this.#aim, this.#aim === "shape" ? [] : this.#place()];
    const seen = await this.#seen();
    if (aim !== this.#aim) return; // another one is looked for meanwhile
    this.#pairs.push({ seen, place });
    this.#forget();
    if (aim === "shape") this.#placeShape();
    else {
      this.#propose();
      await this.#refit();
    }
  }

  async #takeBack() {
    this.#pairs.pop();
    this.#forget();
    this.#propose();
    await this.#refit();
  }

  /** The place that is written in the fields [m]. */
  #place() {
    return this.parts.place.map((input, k) => {
      const { value, fault } = readNumber(input);
      if (value === undefined) throw new Error(`${"xyz"[k]} ${input.value || "is empty; it"} ${fault}.`);
      return value / 1000;
    });
  }

  /** Where the device sees itself; for a shape in robot coordinates. */
  async #seen() {
    const { device, frame } = this.parts;
    const [with_, name] = [this.#device(), frame.value];
    if (this.#pairs.length && with_ !== this.#with)
      throw new Error(`${this.#with} touched the points so far, ${GONE_SENTENCE}.`);
    this.#with = with_;
    const seen = await touch(with_);
    if (this.#aim !== "shape" || with_ === ARM_TOOL) return seen;
    /** @type {MeasuredCalibration[]} */
    const [newest] = await get(resourcePath("calibrations", name));
    if (device.value !== with_) throw new Error("Another device was chosen meanwhile: touch the place again.");
    return mapped(newest.calibration, seen);
  }

  #device() {
    const { value } = this.parts.device;
    if (!value) throw new Error("No tracker is there: start one, and choose it.");
    return value;
  }

  /** Ask the service what the pairs say. */
  async #refit() {
    if (this.#pairs.length < MIN_POINTS) return;
    const pairs = [...this.#pairs];
    const points = pairs.map(({ seen, place }) =>
      this.#aim === "tracker" ? { tracker: seen, world: place } : { tracker: place, world: seen },
    );
    try {
      this.#fit = await put(resourcePath("calibrations", this.#wantedName), {
        points,
        source: this.parts.device.value,
        keep: false,
      });
    } catch (error) {
      this.#fault = error instanceof Error ? error.message : String(error);
    }
  }

  get #wantedName() {
    return (this.#aim === "tracker" && this.parts.name.value.trim()) || UNKEPT;
  }

  /** Touch any place, and say and show where it is by what was found. */
  async #try() {
    const fit = this.#fit;
    if (!fit) return;
    const seen = await this.#seen();
    if (fit !== this.#fit) return;
    const isTracker = this.#aim === "tracker";
    const place = isTracker ? mapped(fit.calibration, seen) : seen;
    const corners = isTracker ? this.#corners() : this.#corners().map((corner) => mapped(fit.calibration, corner));
    const nearest = Math.min(...corners.map((corner) => distance(corner, place)));
    const beside = corners.length ? `, ${lengthText(nearest)} from the nearest corner of the table` : "";
    this.#tried = `Seen at ${placeText(place)}${beside}.`;
    this.#mark(place);
  }

  async #keep() {
    const fit = this.#fit;
    const scene = this.editor.scene();
    if (!fit || !scene) return;
    if (this.#aim === "table") {
      this.editor.changeScene(movedScene(scene, fit.calibration), "moving the scene to the arm");
      this.#restart();
      return this.context.messages.show(
        "The scene is moved, not saved yet: Save version keeps it, Undo takes it back.",
      );
    }
    const name = this.parts.name.value.trim();
    const points = fit.points.map(({ tracker, world }) => ({ tracker, world }));
    /** @type {MeasuredCalibration} */
    const kept = await put(resourcePath("calibrations", name), { points, source: fit.source });
    this.#restart();
    await this.readCalibrations();
    this.context.messages.show(`The calibration ${name} is kept as version ${kept.version}.`);
  }

  #placeShape() {
    const shape = this.editor.shape();
    if (!shape || this.#pairs.length < MIN_POINTS) return;
    const points = this.#pairs.map(({ seen }) => seen);
    this.#pairs = [];
    this.editor.changeShape(placedByTouch(shape, points), `placing ${shape.name} by touch`);
  }

  /** Draw a cross at a place, or take it away. @param {number[] | null} place */
  #mark(place) {
    for (const k of [0, 1, 2]) {
      const ends = place && [-MARK_SIZE, MARK_SIZE].map((by) => place.with(k, place[k] + by));
      this.context.overlay.setLine(`${MARK} ${k}`, ends, { color: 0xd6249f, opacity: 1 });
    }
  }

  #render() {
    const { parts } = this;
    const aim = this.#aim;
    const trackers = this.context.store.state.trackers.map(({ name }) => name);
    refill(parts.device, aim === "table" ? [ARM_TOOL] : aim === "tracker" ? trackers : [...trackers, ARM_TOOL]);
    parts.about.textContent = ABOUT_AIM[aim];
    parts.frameField.hidden = aim !== "shape" || parts.device.value === ARM_TOOL;
    parts.nameField.hidden = aim !== "tracker";
    for (const part of [parts.places, parts.trial, parts.keep]) part.hidden = aim === "shape";
    parts.next.textContent = this.#nextStep();
    patchChildren(parts.points, this.#pairRows());
    parts.verdict.textContent = this.#verdict();
    parts.keep.textContent = aim === "table" ? "Move the scene" : "Keep the calibration";
    const missing = missingSentence(this.context.store.state.identity, ["teach"]) || (this.#isBusy ? "Wait …" : "");
    block(parts.touched, missing || this.#untouchable());
    block(parts.again, missing || (this.#pairs.length ? "" : "No point was touched."));
    block(parts.trial, missing || (this.#fit ? "" : `Touch ${MIN_POINTS} points first.`));
    block(parts.keep, missing || this.#unkeepable());
  }

  /** Why nothing can be touched now. */
  #untouchable() {
    if (!this.parts.device.value) return "No tracker is there: start one, and it appears here.";
    const shape = this.editor.shape();
    if (this.#aim === "shape" && !(shape && shape.kind in THREE_POINTS))
      return "Choose a box, a cylinder or a mesh above first.";
    return this.editor.scene() ? "" : "The scene is not read yet.";
  }

  #unkeepable() {
    if (!this.#fit) return `Touch ${MIN_POINTS} points first.`;
    if (!this.#tried) return "Try it first: touch a place, and look where it is shown.";
    return this.#aim === "tracker" && !this.parts.name.value.trim() ? "Write the name to keep it as." : "";
  }

  #nextStep() {
    const count = this.#pairs.length + 1;
    const shape = this.editor.shape();
    if (this.#aim === "shape") {
      const points = shape && THREE_POINTS[shape.kind];
      return points ? `Point ${count} of 3: ${points[count - 1]} of ${shape.name}.` : this.#untouchable();
    }
    if (!this.parts.device.value) return this.#untouchable();
    return `Point ${count}: ${this.#aim === "table" ? "let the tool's point touch" : "hold the tracker still at"} the place below.`;
  }

  #pairRows() {
    return this.#pairs.map(({ seen, place }, k) => {
      const residual = this.#fit?.points[k]?.residual;
      const off = residual === undefined ? "" : `, ${lengthText(residual)} off`;
      const where = place.length ? `${placeText(place)}, seen at ${placeText(seen)}` : placeText(seen);
      return element("li", { "data-key": String(k) }, `${where}${off}`);
    });
  }

  #verdict() {
    if (this.#fault) return capitalize(this.#fault);
    if (!this.#fit) return "";
    return `Fits within ${lengthText(this.#fit.rms)} (rms over ${this.#pairs.length} points). ${this.#tried}`;
  }
}
