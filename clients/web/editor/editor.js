// The editor: one draft at a time, drawn and dragged in the 3-D view, assessed by the service after every step.
//
// Sections of the panel are { update(editor, what) }; `what` is "draft" (another path or version), "curve" (a step was made),
// "selection" (of control points), "drag" (every frame of a drag), "versions" or "feasibility" (the service has answered),
// or "planning" (a version is being certified).
import { post } from "../api.js";
import { curvesEqual } from "./curve_edits.js";
import { CurveOverlay } from "./curve_overlay.js";
import { Draft } from "./draft.js";
import { FeasibilityCheck } from "./feasibility_check.js";
import { Gizmo } from "./gizmo.js";
import { bindKeyboard, KEYBOARD_HELP } from "./keyboard.js";
import { enablePicking } from "./picking.js";
import { PointDrag } from "./point_drag.js";
import { newDraft, readVersion, readVersions } from "./stored_versions.js";
import { TimingStats } from "./timing_stats.js";

export class Editor {
  opened = Promise.resolve(); // the newest opening; settled when it is over
  /** @type {Draft | null} */
  draft = null;
  /** @type {Curve | null} */
  learned = null;
  /** @type {Version[]} */
  versions = [];
  /** @type {number[] | null} */
  spread = null; // radii of the corridor around what was learned [m]
  /** @type {import("./certification.js").Planning | null} */
  planning = null; // begun last in this tab
  shown = false;
  timings = new TimingStats();
  #hasKeyboardLabel = false;
  /** @type {EditorSection[]} */
  #sections = [];
  #openRequest = 0;

  /** @param {Context} context */
  constructor(context) {
    this.context = context;
    this.overlay = context.overlay;
    this.curveOverlay = new CurveOverlay(this.overlay);
    this.check = new FeasibilityCheck(
      () => (this.active ? this.draft : null),
      (_, ms) => {
        if (ms !== null) this.timings.addAnswer(ms);
        this.notify("feasibility");
      },
    );
    this.drag = new PointDrag(this);
    this.gizmo = new Gizmo(this.overlay, this.drag);
    enablePicking(this, this.overlay, this.gizmo);
    bindKeyboard(this, this.overlay);
  }

  /** Whether the arm can follow the draft, as far as it is known. */
  get feasibility() {
    return this.check.current;
  }

  /** @param {...EditorSection} sections */
  add(...sections) {
    this.#sections.push(...sections);
  }

  /** Whether the editor takes pointer and keyboard. */
  get active() {
    return this.shown && this.draft !== null;
  }

  /** The centre of the selected control points, or null. */
  get selectionCenter() {
    if (!this.draft?.selected.length) return null;
    const { selected, curve } = this.draft;
    const points = selected.map((index) => curve.control_points[index]);
    return [0, 1, 2].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  }

  /** @param {boolean} shown */
  show(shown) {
    this.shown = shown;
    this.context.view.setDimmed("paths", this.active);
    this.curveOverlay.show(this.active);
    if (this.active) this.#redrawAll();
    else this.gizmo.attachTo(null);
    const label = this.active ? `3-D view, control points of the path. ${KEYBOARD_HELP}` : "";
    if (this.active || this.#hasKeyboardLabel) this.overlay.setKeyboardLabel(label);
    this.#hasKeyboardLabel = this.active;
  }

  /**
   * Edit a path: the draft that this browser tab has begun, else the newest version on its main branch.
   * @param {string} path
   * @param {number[] | null} spread
   */
  open(path, spread) {
    this.opened = this.#open(path, spread);
    return this.opened;
  }

  /** @param {string} path @param {number[] | null} spread */
  async #open(path, spread) {
    const request = ++this.#openRequest;
    if (path === this.draft?.path) return;
    const [versions, first] = await Promise.all([readVersions(path), readVersion(path, 1)]);
    const draft = Draft.restore(path) ?? (await newDraft(path, versions));
    if (request !== this.#openRequest) return; // another path was opened meanwhile
    this.drag.end(); // a drag under way is a step of the former draft
    Object.assign(this, { draft, versions, spread, learned: first.path.curve });
    this.show(this.shown);
    if (!this.shown) this.#redrawAll();
  }

  close() {
    this.#openRequest += 1;
    this.draft = null;
    this.show(this.shown);
    this.notify("draft");
  }

  async readVersions() {
    if (!this.draft) return;
    const { path } = this.draft;
    const versions = await readVersions(path);
    const isOlder = versions.length < this.versions.length; // no version is ever taken away
    if (path !== this.draft?.path || isOlder) return;
    this.versions = versions;
    this.notify("versions");
  }

  /**
   * Go on from a stored version; what was edited, until it is here too, stays one step back.
   * @param {number} number
   * @param {Draft | null} draft
   */
  async loadVersion(number, draft = this.draft) {
    if (!draft) return;
    const { version, path } = await readVersion(draft.path, number);
    if (draft === this.draft) this.drag.end();
    draft.rebase(version, path.curve, `going on from version ${number}`);
    if (draft === this.draft) this.#redrawAll();
  }

  /** @param {number[]} indices of control points */
  select(indices) {
    if (!this.draft) return;
    this.draft.select(indices);
    this.curveOverlay.setSelection(this.draft);
    this.#placeGizmo();
    this.notify("selection");
  }

  /** @param {Curve} curve @param {string} what names the step */
  change(curve, what) {
    this.draft?.change(curve, what);
    this.curveChanged();
  }

  undo() {
    this.draft?.undo();
    this.curveChanged();
  }

  redo() {
    this.draft?.redo();
    this.curveChanged();
  }

  /** @param {boolean} unlocked start and goal may be moved */
  unlock(unlocked) {
    if (!this.draft) return;
    this.draft.unlocked = unlocked;
    this.draft.persist();
    this.select(this.draft.selected);
  }

  /**
   * Insert-knot, remove-knot or elevate: the service computes it, the shape stays. Null when it was edited meanwhile.
   * @param {string} operation
   * @param {object} more
   * @param {string} what names the step
   */
  async applyOperation(operation, more, what) {
    const { draft } = this;
    if (!draft) return null;
    const { curve } = draft;
    /** @type {EditResult} */
    const result = await post(`curves/${operation}`, { curve, ...more });
    if (draft !== this.draft || this.drag.active || !curvesEqual(curve, draft.curve)) return null;
    this.change(result.curve, what);
    return result;
  }

  /** The draft's base has changed, its curve has not. */
  refresh() {
    this.#drawReference();
    this.notify("draft");
    this.notify("curve");
  }

  /** A step of the draft was made or undone. */
  curveChanged() {
    if (!this.draft) return;
    this.curveOverlay.setCurve(this.draft.curve);
    this.select(this.draft.selected);
    this.notify("curve");
    this.check.request();
  }

  /** The draft's curve is being dragged: what a frame draws. */
  curveDragged() {
    if (!this.draft) return;
    this.curveOverlay.setCurve(this.draft.curve);
    this.#placeGizmo();
    this.notify("drag");
  }

  /** @param {import("./certification.js").Planning} planning that was begun */
  followPlanning(planning) {
    this.planning = planning;
    this.notify("planning");
  }

  /** @param {EditorChange} what */
  notify(what) {
    for (const section of this.#sections) section.update(this, what);
  }

  #redrawAll() {
    this.#drawReference();
    this.notify("draft");
    this.curveChanged();
  }

  #drawReference() {
    if (this.draft) this.curveOverlay.setReference(this.draft.original, this.learned, this.spread);
  }

  #placeGizmo() {
    this.gizmo.attachTo(this.active && this.draft?.movable.length ? this.selectionCenter : null);
  }
}
