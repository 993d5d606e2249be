// The draft: the curve as it is edited, the version it began from, the selected control points, and the steps of undo.
//
// A draft lives in this tab: it survives a reload (sessionStorage), and the service knows nothing of it before it is saved.
import { curvesEqual } from "./curve_edits.js";

const STORAGE_KEY = "teachpath.draft/";
const MAX_STORED_CHARACTERS = 1_500_000; // beyond, the older steps are left out

/**
 * @typedef {Pick<Version, "number" | "branch" | "name">} BaseVersion the version that is edited
 * @typedef {{base: BaseVersion, original: Curve}} Origin
 * @typedef {{curve: Curve, what: string, origin?: Origin}} Step what was before it, and its name; the origin where it changed
 */

export class Draft {
  /** @type {Step[]} */
  #past = [];
  /** @type {Step[]} */
  #future = [];
  /** @type {Curve | null} */
  #beforeDrag = null; // the curve when the present drag began

  unlocked = false;
  /** @type {number[]} */
  selected = []; // control points

  /**
   * @param {string} path
   * @param {BaseVersion} base
   * @param {Curve} original the curve of the base
   * @param {Pick<Storage, "getItem" | "setItem">} storage keeps the draft
   */
  constructor(path, base, original, storage = sessionStorage) {
    this.path = path;
    this.base = base;
    this.original = original;
    this.curve = original;
    this.storage = storage;
  }

  get edited() {
    return !curvesEqual(this.curve, this.original);
  }

  get last() {
    return this.curve.control_points.length - 1;
  }

  get undoLabel() {
    return this.#past.at(-1)?.what ?? "";
  }

  get redoLabel() {
    return this.#future.at(-1)?.what ?? "";
  }

  /** @param {number} index */
  isPinned(index) {
    return !this.unlocked && (index === 0 || index === this.last);
  }

  /** The selected control points that may be moved. */
  get movable() {
    return this.selected.filter((index) => !this.isPinned(index));
  }

  /** @param {number[]} indices */
  select(indices) {
    this.selected = [...new Set(indices)].filter((i) => i >= 0 && i <= this.last).sort((a, b) => a - b);
  }

  /**
   * Make one step.
   * @param {Curve} curve
   * @param {string} what names it for undo and redo
   */
  change(curve, what) {
    if (curvesEqual(curve, this.curve)) return;
    this.#past.push({ curve: this.curve, what });
    this.#future = [];
    this.#setCurve(curve);
    this.persist();
  }

  /** A drag: any number of curves between beginDrag() and endDrag() are one step. */
  beginDrag() {
    this.#beforeDrag = this.curve;
  }

  /** @param {Curve} curve */
  preview(curve) {
    this.curve = curve;
  }

  /** @param {string} what */
  endDrag(what) {
    if (!this.#beforeDrag) return;
    const curve = this.curve;
    this.curve = this.#beforeDrag;
    this.#beforeDrag = null;
    this.change(curve, what);
  }

  cancelDrag() {
    if (this.#beforeDrag) this.curve = this.#beforeDrag;
    this.#beforeDrag = null;
  }

  undo() {
    this.#step(this.#past, this.#future);
  }

  redo() {
    this.#step(this.#future, this.#past);
  }

  /**
   * Go on from another version; what was edited stays one step back.
   * @param {BaseVersion} base
   * @param {Curve} original
   * @param {string} what
   */
  rebase(base, original, what) {
    const origin = { base: this.base, original: this.original };
    this.base = base;
    this.original = original;
    if (curvesEqual(original, this.curve)) return this.persist();
    this.change(original, what);
    this.#past[this.#past.length - 1].origin = origin; // to which undo goes back, lest mine be saved as made from theirs
    this.persist();
  }

  /**
   * A curve has been saved as this version; the draft may be a step further by now.
   * @param {BaseVersion} base
   * @param {Curve} curve
   */
  saved(base, curve) {
    this.base = base;
    this.original = curve;
    this.persist();
  }

  persist() {
    const { path, base, original, curve, unlocked } = this;
    let [past, future] = [this.#past, this.#future];
    let text = JSON.stringify({ base, original, curve, unlocked, past, future });
    while (text.length > MAX_STORED_CHARACTERS && past.length > 1) {
      past = past.slice(Math.ceil(past.length / 2));
      future = [];
      text = JSON.stringify({ base, original, curve, unlocked, past, future });
    }
    this.storage.setItem(STORAGE_KEY + path, text);
  }

  /**
   * The draft of a path that this tab has begun earlier, or null.
   * @param {string} path
   * @param {Pick<Storage, "getItem" | "setItem">} storage
   */
  static restore(path, storage = sessionStorage) {
    try {
      const { base, original, curve, unlocked, past, future } = JSON.parse(storage.getItem(STORAGE_KEY + path) ?? "");
      const draft = new Draft(path, base, original, storage);
      Object.assign(draft, { curve, unlocked });
      draft.#past = past;
      draft.#future = future;
      return draft;
    } catch {
      return null;
    }
  }

  /** @param {Step[]} from @param {Step[]} to */
  #step(from, to) {
    const step = from.pop();
    if (!step) return;
    this.cancelDrag();
    const origin = step.origin && { base: this.base, original: this.original };
    to.push({ curve: this.curve, what: step.what, origin });
    if (step.origin) Object.assign(this, step.origin);
    this.#setCurve(step.curve);
    this.persist();
  }

  /** @param {Curve} curve */
  #setCurve(curve) {
    this.curve = curve;
    this.select(this.selected);
  }
}
