// The pointer on the control points: select, drag in the plane of the picture, select with a box.
/** How near a press must be, and how far a click may move. @type {Record<string, {near: number, still: number}>} [px] */
const PRECISION = { mouse: { near: 12, still: 3 }, pen: { near: 16, still: 4 }, touch: { near: 28, still: 8 } };

/**
 * What a press has begun; at = [x, y] in CSS pixels.
 * @typedef {{move(at: number[]): void, up(cancelled: boolean): void}} Gesture
 *
 * @typedef {import("../overlay.js").Overlay} Overlay
 */

/** @param {Editor} editor @param {Overlay} overlay @param {import("./gizmo.js").Gizmo} gizmo it comes first */
export function enablePicking(editor, overlay, gizmo) {
  /** @type {Gesture | null} */
  let gesture = null;
  /** @param {PointerEvent} event */
  const down = (event) => {
    if (!editor.active || !editor.draft || event.button !== 0 || gizmo.isHovered) return false;
    const at = [event.clientX, event.clientY];
    const { near, still } = PRECISION[event.pointerType] ?? PRECISION.mouse;
    const index = nearest(editor.draft.curve.control_points, overlay, at, near);
    if (index === null && !event.shiftKey) return false; // the camera's
    overlay.element.focus({ preventScroll: true });
    if (index === null) gesture = new BoxGesture(editor, overlay, at);
    else if (event.shiftKey) gesture = toggle(editor, index);
    else gesture = new DragGesture(editor, overlay, index, at, still);
    return true;
  };
  overlay.capturePointer({
    down,
    move: (event) => gesture?.move([event.clientX, event.clientY]),
    up: (event) => gesture?.up(event === null),
  });
}

/**
 * The control point under a pixel, or null.
 * @param {Point[]} points
 * @param {Overlay} overlay
 * @param {number[]} pixel
 * @param {number} least
 */
function nearest(points, overlay, [x, y], least) {
  let best = null;
  for (const [i, point] of points.entries()) {
    const seen = overlay.project(point);
    const off = seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity;
    if (off <= least) [best, least] = [i, off];
  }
  return best;
}

class DragGesture {
  #moving = false;

  /** @param {Editor} editor @param {Overlay} overlay @param {number} index @param {number[]} at @param {number} still */
  constructor(editor, overlay, index, at, still) {
    this.still = still;
    this.editor = editor;
    this.overlay = overlay;
    this.at = at;
    if (!editor.draft?.selected.includes(index)) editor.select([index]);
    this.through = editor.draft?.curve.control_points[index];
    this.from = this.#pointAt(at);
  }

  /** @param {number[]} at */
  move(at) {
    if (!this.#moving) {
      if (Math.hypot(at[0] - this.at[0], at[1] - this.at[1]) <= this.still) return;
      if (!this.editor.drag.begin()) return;
      this.#moving = true;
    }
    const { from } = this;
    const to = this.#pointAt(at);
    if (from && to) this.editor.drag.move(to.map((value, axis) => value - from[axis]));
  }

  /** @param {boolean} cancelled */
  up(cancelled) {
    if (!this.#moving) return;
    this.#moving = false;
    if (cancelled) this.editor.drag.cancel();
    else this.editor.drag.end();
  }

  /** @param {number[]} at */
  #pointAt(at) {
    return this.overlay.unproject(at[0], at[1], { through: this.through });
  }
}

/**
 * Add a control point to the selection, or take it out; nothing moves.
 * @param {Editor} editor
 * @param {number} index
 * @returns {Gesture}
 */
function toggle(editor, index) {
  const { selected = [] } = editor.draft ?? {};
  editor.select(selected.includes(index) ? selected.filter((i) => i !== index) : [...selected, index]);
  return { move() {}, up() {} };
}

/** A rectangle on the screen; the control points in it are added to the selection. */
class BoxGesture {
  /** @param {Editor} editor @param {Overlay} overlay @param {number[]} at */
  constructor(editor, overlay, at) {
    this.editor = editor;
    this.overlay = overlay;
    this.at = at;
    this.to = at;
    this.element = document.createElement("div");
    this.element.className = "selection-box";
    document.body.append(this.element);
    this.move(at);
  }

  /** @param {number[]} to */
  move(to) {
    this.to = to;
    const [[left, right], [top, bottom]] = this.#sides();
    const pixels = { left, top, width: right - left, height: bottom - top };
    for (const [name, value] of Object.entries(pixels)) this.element.style.setProperty(name, `${value}px`);
  }

  /** @param {boolean} cancelled */
  up(cancelled) {
    this.element.remove();
    const { draft } = this.editor;
    if (cancelled || !draft) return;
    const sides = this.#sides();
    const found = draft.curve.control_points.flatMap((point, i) => {
      const seen = this.overlay.project(point);
      return seen && sides.every(([low, high], axis) => low <= seen[axis] && seen[axis] <= high) ? [i] : [];
    });
    this.editor.select([...draft.selected, ...found]);
  }

  /** Lower and upper end of both axes. */
  #sides() {
    return [0, 1].map((axis) => [Math.min(this.at[axis], this.to[axis]), Math.max(this.at[axis], this.to[axis])]);
  }
}
