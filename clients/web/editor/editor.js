// The editor: one draft at a time, drawn and grabbed in the 3-D view, looked at by the service after every step.
//
// Parts of the panel are { update(editor, what) }; `what` is "draft" (another path or version), "curve" (a step was made),
// "choice" (other control points are chosen), "drag" (every frame of a gesture) or "verdict" (the service has looked).
import { at, get, post } from "../api.js";
import { movedBy, sameCurve } from "./curve_edits.js";
import { Draft } from "./draft.js";
import { Gizmo } from "./gizmo.js";
import { grab } from "./picking.js";
import { HELP, keys } from "./keyboard.js";
import { Sketch } from "./curve_overlay.js";
import { Stopwatch } from "./timing_stats.js";

const MAIN = "main";
const AGAIN = 1000; // [ms] before the service is asked again

export class Editor {
  opened = Promise.resolve(); // the newest opening; settled when it is over
  #parts = [];
  #gesture = null; // {curve, indices, by} while something is dragged
  #frame = 0;
  #asked = 0;

  constructor(context) {
    Object.assign(this, { context, draft: null, learned: null, versions: [], verdict: null, shown: false });
    this.easel = context.easel;
    this.stopwatch = new Stopwatch();
    this.sketch = new Sketch(this.easel);
    const gesture = { begin: () => this.begin(), drag: (by) => this.drag(by), end: () => this.end() };
    this.gizmo = new Gizmo(this.easel, gesture);
    grab(this, this.easel, this.gizmo);
    keys(this, this.easel);
  }

  add(...parts) {
    this.#parts.push(...parts);
  }

  // Whether the pointer and the keyboard are the editor's.
  get active() {
    return this.shown && this.draft !== null;
  }

  // The middle of what is chosen, or null.
  get middle() {
    const { chosen, curve } = this.draft;
    if (!chosen.length) return null;
    return [0, 1, 2].map((axis) => chosen.reduce((sum, i) => sum + curve.control_points[i][axis], 0) / chosen.length);
  }

  show(shown) {
    this.shown = shown;
    this.context.view.fade("paths", shown && this.draft !== null);
    this.sketch.show(this.active);
    if (this.active) this.#all();
    else this.gizmo.place(null);
    if (this.active || this.labelled) this.easel.keys(this.active ? `3-D view, control points of the path. ${HELP}` : "");
    this.labelled = this.active;
  }

  // Edit a path: the draft that this tab has begun, else the newest version on its main branch. `spread`: the radii
  // of the corridor around what was learned [m], or null.
  open(path, spread) {
    this.opened = this.#open(path, spread);
    return this.opened;
  }

  async #open(path, spread) {
    const turn = ++this.#asked;
    if (path === this.draft?.path) return;
    const [versions, first] = await Promise.all([get(at("paths", path, "versions")), get(at("paths", path, "versions", 1))]);
    let draft = Draft.of(path);
    if (!draft) {
      const newest = versions.findLast((version) => version.branch === MAIN);
      draft = new Draft(path, newest, (await get(at("paths", path, "versions", newest.number))).path.curve);
    }
    if (turn !== this.#asked) return; // another path was opened meanwhile
    this.end(); // a gesture under way is a step of the former draft
    Object.assign(this, { draft, versions, spread, learned: first.path.curve });
    this.show(this.shown);
    if (!this.shown) this.#all();
  }

  close() {
    this.#asked += 1;
    this.draft = null;
    this.show(this.shown);
    this.tell("draft");
  }

  async readVersions() {
    if (!this.draft) return;
    const { path } = this.draft;
    const versions = await get(at("paths", path, "versions"));
    if (path !== this.draft?.path || versions.length < this.versions.length) return; // an older answer: none is ever taken away
    this.versions = versions;
    this.tell("versions");
  }

  // Go on from a stored version; what was edited, until it is here too, stays one step back.
  async take(number, draft = this.draft) {
    const { version, path } = await get(at("paths", draft.path, "versions", number));
    if (draft === this.draft) this.end();
    draft.rebase(version, path.curve, `going on from version ${number}`);
    if (draft === this.draft) this.#all();
  }

  choose(indices) {
    this.draft.choose(indices);
    this.sketch.choice(this.draft);
    this.#placeGizmo();
    this.tell("choice");
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
    this.draft.keep();
    this.choose(this.draft.chosen);
  }

  // A gesture: false when nothing that is chosen may be moved.
  begin() {
    const indices = this.draft.movable;
    if (!indices.length) {
      const why = this.draft.chosen.length ? "Start and goal are pinned. Unlock them to move them." : "Choose a control point first.";
      this.context.messages.say(why);
      return false;
    }
    this.draft.begin();
    this.#gesture = { curve: this.draft.curve, indices, by: [0, 0, 0] };
    this.sketch.paint(null);
    return true;
  }

  // Move what is chosen by so much since the gesture began [m]; drawn once in the next frame.
  drag(by) {
    if (!this.#gesture) return;
    this.#gesture.by = by;
    this.#frame ||= requestAnimationFrame(() => this.#redraw());
  }

  end() {
    if (!this.#gesture) return;
    const { indices } = this.#gesture;
    this.#redraw();
    this.#gesture = null;
    this.draft.end(indices.length === 1 ? `moving control point ${indices[0] + 1}` : `moving ${indices.length} control points`);
    this.#changed();
  }

  abandon() {
    this.#gesture = null;
    this.draft.abandon();
    this.#changed();
  }

  // Insert-knot, remove-knot or elevate: the service computes it, the shape stays.
  async operate(operation, more, what) {
    const { curve, path } = this.draft;
    const answer = await post(`curves/${operation}`, { curve, ...more });
    if (path !== this.draft?.path || this.#gesture || !sameCurve(curve, this.draft.curve)) return null; // edited meanwhile
    this.change(answer.curve, what);
    return answer;
  }

  // The draft's base has changed, its curve has not.
  refresh() {
    this.sketch.ghosts(this.draft.original, this.learned, this.spread);
    this.tell("draft");
    this.tell("curve");
  }

  tell(what) {
    for (const part of this.#parts) part.update(this, what);
  }

  #redraw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    if (!this.#gesture) return;
    this.stopwatch.time(() => {
      const { curve, indices, by } = this.#gesture;
      this.draft.preview(movedBy(curve, indices, by));
      this.sketch.redraw(this.draft);
      this.#placeGizmo();
      this.tell("drag");
    }, this.context.view);
  }

  #all() {
    this.sketch.ghosts(this.draft.original, this.learned, this.spread);
    this.tell("draft");
    this.#changed();
  }

  #changed() {
    this.sketch.redraw(this.draft);
    this.choose(this.draft.chosen);
    this.tell("curve");
    this.#assess();
  }

  #placeGizmo() {
    this.gizmo.place(this.active && this.draft.movable.length ? this.middle : null);
  }

  // Ask the service what the arm thinks of the curve while somebody looks at it; only the answer to the newest question
  // counts. It looks at one curve of a path at a time, and another tab may be asking about this one.
  async #assess(again = false) {
    if (!this.active) return;
    const { path, curve, base } = this.draft;
    const { verdict: known } = this;
    if (known?.curve === curve && !known.waiting && !known.again && !again) return;
    this.#judge({ curve, waiting: true });
    if (this.asking) return; // one question at a time; the newest curve comes next
    this.asking = true;
    const began = performance.now();
    let verdict;
    try {
      verdict = { curve, assessment: await post(at("paths", path, "assessment"), { curve, version: base.number }) };
      this.stopwatch.answered(performance.now() - began);
    } catch (error) {
      verdict = { curve, refusal: error.message, again: error.status === 409 || error.status === 0 };
    }
    this.asking = false;
    if (!this.draft) return;
    if (this.draft.curve !== curve) {
      this.#assess(true);
      return;
    }
    this.#judge(verdict);
    // Somebody else's curve of this path came first, or the service was away: ask again.
    if (verdict.again) setTimeout(() => this.draft?.curve === curve && this.#assess(true), AGAIN);
  }

  #judge(verdict) {
    this.verdict = verdict;
    this.tell("verdict");
  }
}
