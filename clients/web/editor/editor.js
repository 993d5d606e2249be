// The editor: one draft at a time, drawn and dragged in the 3-D view, assessed by the service after every step.
//
// Sections of the panel are { update(editor, what) }; `what` is "draft" (another path or version), "curve" (a step was made),
// "selection" (of control points), "drag" (every frame of a drag), "versions" or "feasibility" (the service has answered).
import { get, post, resourcePath } from "../api.js";
import { curvesEqual, movePoints } from "./curve_edits.js";
import { CurveOverlay } from "./curve_overlay.js";
import { Draft } from "./draft.js";
import { Gizmo } from "./gizmo.js";
import { bindKeyboard, KEYBOARD_HELP } from "./keyboard.js";
import { enablePicking } from "./picking.js";
import { TimingStats } from "./timing_stats.js";

const MAIN_BRANCH = "main";
const RETRY_DELAY = 1000; // [ms] before the service is asked again

export class Editor {
  opened = Promise.resolve(); // the newest opening; settled when it is over
  #sections = [];
  #drag = null; // {curve, indices, by} during a drag
  #frame = 0;
  #openRequest = 0;

  constructor(context) {
    Object.assign(this, { context, draft: null, learned: null, versions: [], feasibility: null, shown: false });
    this.overlay = context.overlay;
    this.timings = new TimingStats();
    this.curveOverlay = new CurveOverlay(this.overlay);
    const listeners = { beginDrag: () => this.beginDrag(), drag: (by) => this.drag(by), endDrag: () => this.endDrag() };
    this.gizmo = new Gizmo(this.overlay, listeners);
    enablePicking(this, this.overlay, this.gizmo);
    bindKeyboard(this, this.overlay);
  }

  add(...sections) {
    this.#sections.push(...sections);
  }

  // Whether the editor takes pointer and keyboard.
  get active() {
    return this.shown && this.draft !== null;
  }

  // The centre of the selected control points, or null.
  get selectionCenter() {
    const { selected, curve } = this.draft;
    if (!selected.length) return null;
    return [0, 1, 2].map(
      (axis) => selected.reduce((sum, i) => sum + curve.control_points[i][axis], 0) / selected.length,
    );
  }

  show(shown) {
    this.shown = shown;
    this.context.view.setDimmed("paths", shown && this.draft !== null);
    this.curveOverlay.show(this.active);
    if (this.active) this.#redrawAll();
    else this.gizmo.attachTo(null);
    if (this.active || this.hasKeyboardLabel)
      this.overlay.setKeyboardLabel(this.active ? `3-D view, control points of the path. ${KEYBOARD_HELP}` : "");
    this.hasKeyboardLabel = this.active;
  }

  // Edit a path: the draft that this browser tab has begun, else the newest version on its main branch. `spread`: the radii
  // of the corridor around what was learned [m], or null.
  open(path, spread) {
    this.opened = this.#open(path, spread);
    return this.opened;
  }

  async #open(path, spread) {
    const request = ++this.#openRequest;
    if (path === this.draft?.path) return;
    const [versions, first] = await Promise.all([
      get(resourcePath("paths", path, "versions")),
      get(resourcePath("paths", path, "versions", 1)),
    ]);
    let draft = Draft.restore(path);
    if (!draft) {
      const newest = versions.findLast((version) => version.branch === MAIN_BRANCH);
      draft = new Draft(path, newest, (await get(resourcePath("paths", path, "versions", newest.number))).path.curve);
    }
    if (request !== this.#openRequest) return; // another path was opened meanwhile
    this.endDrag(); // a gesture under way is a step of the former draft
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
    const versions = await get(resourcePath("paths", path, "versions"));
    if (path !== this.draft?.path || versions.length < this.versions.length) return; // an older answer: none is ever taken away
    this.versions = versions;
    this.notify("versions");
  }

  // Go on from a stored version; what was edited, until it is here too, stays one step back.
  async loadVersion(number, draft = this.draft) {
    const { version, path } = await get(resourcePath("paths", draft.path, "versions", number));
    if (draft === this.draft) this.endDrag();
    draft.rebase(version, path.curve, `going on from version ${number}`);
    if (draft === this.draft) this.#redrawAll();
  }

  select(indices) {
    this.draft.select(indices);
    this.curveOverlay.setSelection(this.draft);
    this.#placeGizmo();
    this.notify("selection");
  }

  change(curve, what) {
    this.draft.change(curve, what);
    this.#changed();
  }

  undo() {
    this.draft.undo();
    this.#changed();
  }

  redo() {
    this.draft.redo();
    this.#changed();
  }

  unlock(value) {
    this.draft.unlocked = value;
    this.draft.persist();
    this.select(this.draft.selected);
  }

  // Begin a drag; false when no selected control point may be moved.
  beginDrag() {
    const indices = this.draft.movable;
    if (!indices.length) {
      const why = this.draft.selected.length
        ? "Start and goal are pinned. Unlock them to move them."
        : "Choose a control point first.";
      this.context.messages.show(why);
      return false;
    }
    this.draft.beginDrag();
    this.#drag = { curve: this.draft.curve, indices, by: [0, 0, 0] };
    this.curveOverlay.setColors(null);
    return true;
  }

  // Move the selected control points by so much since the drag began [m]; drawn once in the next frame.
  drag(by) {
    if (!this.#drag) return;
    this.#drag.by = by;
    this.#frame ||= requestAnimationFrame(() => this.#redraw());
  }

  endDrag() {
    if (!this.#drag) return;
    const { indices } = this.#drag;
    this.#redraw();
    this.#drag = null;
    this.draft.endDrag(
      indices.length === 1 ? `moving control point ${indices[0] + 1}` : `moving ${indices.length} control points`,
    );
    this.#changed();
  }

  cancelDrag() {
    this.#drag = null;
    this.draft.cancelDrag();
    this.#changed();
  }

  // Insert-knot, remove-knot or elevate: the service computes it, the shape stays.
  async applyOperation(operation, more, what) {
    const { curve, path } = this.draft;
    const answer = await post(`curves/${operation}`, { curve, ...more });
    if (path !== this.draft?.path || this.#drag || !curvesEqual(curve, this.draft.curve)) return null; // edited meanwhile
    this.change(answer.curve, what);
    return answer;
  }

  // The draft's base has changed, its curve has not.
  refresh() {
    this.curveOverlay.setReference(this.draft.original, this.learned, this.spread);
    this.notify("draft");
    this.notify("curve");
  }

  notify(what) {
    for (const section of this.#sections) section.update(this, what);
  }

  #redraw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    if (!this.#drag) return;
    this.timings.measureFrame(() => {
      const { curve, indices, by } = this.#drag;
      this.draft.preview(movePoints(curve, indices, by));
      this.curveOverlay.setCurve(this.draft);
      this.#placeGizmo();
      this.notify("drag");
    }, this.context.view);
  }

  #redrawAll() {
    this.curveOverlay.setReference(this.draft.original, this.learned, this.spread);
    this.notify("draft");
    this.#changed();
  }

  #changed() {
    this.curveOverlay.setCurve(this.draft);
    this.select(this.draft.selected);
    this.notify("curve");
    this.#assess();
  }

  #placeGizmo() {
    this.gizmo.attachTo(this.active && this.draft.movable.length ? this.selectionCenter : null);
  }

  // Ask the service whether the arm can follow the curve, while the editor is shown; only the answer for the newest curve
  // counts. The service assesses one curve of a path at a time, and another tab may be asking about this path.
  async #assess(retry = false) {
    if (!this.active) return;
    const { path, curve, base } = this.draft;
    const { feasibility: previous } = this;
    if (previous?.curve === curve && !previous.pending && !previous.retry && !retry) return;
    this.#setFeasibility({ curve, pending: true });
    if (this.assessing) return; // one request at a time; the newest curve comes next
    this.assessing = true;
    const began = performance.now();
    let feasibility;
    try {
      feasibility = {
        curve,
        assessment: await post(resourcePath("paths", path, "assessment"), { curve, version: base.number }),
      };
      this.timings.addAnswer(performance.now() - began);
    } catch (error) {
      feasibility = { curve, error: error.message, retry: error.status === 409 || error.status === 0 };
    }
    this.assessing = false;
    if (!this.draft) return;
    if (this.draft.curve !== curve) {
      this.#assess(true);
      return;
    }
    this.#setFeasibility(feasibility);
    // Somebody else's curve of this path came first, or the service was away: ask again.
    if (feasibility.retry) setTimeout(() => this.draft?.curve === curve && this.#assess(true), RETRY_DELAY);
  }

  #setFeasibility(feasibility) {
    this.feasibility = feasibility;
    this.notify("feasibility");
  }
}
