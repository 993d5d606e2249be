// The draft: the curve as it is edited, what it began from, which control points are chosen, and every step back.
//
// A draft lives in this tab: it survives a reload (sessionStorage), and the service knows nothing of it before it is saved.
import { sameCurve } from "./curve_edits.js";

const KEY = "teachpath.draft/";
const LARGEST = 1_500_000; // characters that the storage is asked to hold; older steps are left out beyond

export class Draft {
  #past = [];
  #future = [];
  #held = null; // the curve when the present gesture began

  // `base` = {number, branch}: the version that is edited; `original`: its curve.
  constructor(path, base, original) {
    Object.assign(this, { path, base, original, curve: original, unlocked: false, chosen: [] });
  }

  get edited() {
    return !sameCurve(this.curve, this.original);
  }

  get last() {
    return this.curve.control_points.length - 1;
  }

  get undoable() {
    return this.#past.at(-1)?.what ?? "";
  }

  get redoable() {
    return this.#future.at(-1)?.what ?? "";
  }

  isPinned(index) {
    return !this.unlocked && (index === 0 || index === this.last);
  }

  // The chosen control points that may be moved.
  get movable() {
    return this.chosen.filter((index) => !this.isPinned(index));
  }

  choose(indices) {
    this.chosen = [...new Set(indices)].filter((i) => i >= 0 && i <= this.last).sort((a, b) => a - b);
  }

  // One step: `what` says it in words, for undo and redo.
  change(curve, what) {
    if (sameCurve(curve, this.curve)) return;
    this.#past.push({ curve: this.curve, what });
    this.#future = [];
    this.#take(curve);
    this.keep();
  }

  // A gesture: any number of curves between begin() and end() are one step.
  begin() {
    this.#held = this.curve;
  }

  preview(curve) {
    this.curve = curve;
  }

  end(what) {
    if (!this.#held) return;
    const curve = this.curve;
    this.curve = this.#held;
    this.#held = null;
    this.change(curve, what);
  }

  abandon() {
    if (this.#held) this.curve = this.#held;
    this.#held = null;
  }

  undo() {
    this.#step(this.#past, this.#future);
  }

  redo() {
    this.#step(this.#future, this.#past);
  }

  // Go on from another version; what was edited stays one step back.
  rebase(base, original, what) {
    this.base = base;
    this.original = original;
    this.change(original, what);
    this.keep();
  }

  // A curve has been saved as this version; the draft may be a step further by now.
  saved(base, curve) {
    this.base = base;
    this.original = curve;
    this.keep();
  }

  keep() {
    const { path, base, original, curve, unlocked } = this;
    let [past, future] = [this.#past, this.#future];
    let text = JSON.stringify({ base, original, curve, unlocked, past, future });
    while (text.length > LARGEST && past.length > 1) {
      past = past.slice(Math.ceil(past.length / 2));
      future = [];
      text = JSON.stringify({ base, original, curve, unlocked, past, future });
    }
    sessionStorage.setItem(KEY + path, text);
  }

  // The draft of a path that this tab has begun earlier, or null.
  static of(path) {
    try {
      const { base, original, curve, unlocked, past, future } = JSON.parse(sessionStorage.getItem(KEY + path));
      const draft = new Draft(path, base, original);
      Object.assign(draft, { curve, unlocked });
      draft.#past = past;
      draft.#future = future;
      return draft;
    } catch {
      return null;
    }
  }

  #step(from, to) {
    const step = from.pop();
    if (!step) return;
    this.abandon();
    to.push({ curve: this.curve, what: step.what });
    this.#take(step.curve);
    this.keep();
  }

  #take(curve) {
    this.curve = curve;
    this.choose(this.chosen);
  }
}
