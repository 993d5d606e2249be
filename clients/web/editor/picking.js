// The pointer on the control points: select, drag in the plane of the picture, select with a box.
const PICK_RADIUS = 12; // [px]
const CLICK_TOLERANCE = 3; // [px] that a click may move

// `editor` has draft, select(indices), beginDrag(), drag(by), endDrag(), cancelDrag(); the `gizmo` comes first.
export function enablePicking(editor, overlay, gizmo) {
  let gesture = null;

  const down = (event) => {
    if (!editor.active || event.button !== 0 || gizmo.isHovered) return false;
    const at = [event.clientX, event.clientY];
    const index = nearest(editor.draft.curve.control_points, overlay, at);
    if (index === null && !event.shiftKey) return false; // the camera's
    overlay.element.focus({ preventScroll: true });
    if (index === null) gesture = new BoxGesture(editor, overlay, at);
    else if (event.shiftKey) gesture = new ToggleGesture(editor, index);
    else gesture = new DragGesture(editor, overlay, index, at);
    return true;
  };
  overlay.capturePointer({
    down,
    move: (event) => gesture?.move([event.clientX, event.clientY]),
    up: (event) => gesture?.up(event === null),
  });
}

function nearest(points, overlay, [x, y]) {
  let best = null;
  let least = PICK_RADIUS;
  points.forEach((point, i) => {
    const seen = overlay.project(point);
    const off = seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity;
    if (off <= least) [best, least] = [i, off];
  });
  return best;
}

class DragGesture {
  constructor(editor, overlay, index, at) {
    Object.assign(this, { editor, overlay, at });
    if (!editor.draft.selected.includes(index)) editor.select([index]);
    this.through = editor.draft.curve.control_points[index];
    this.from = overlay.unproject(...at, { through: this.through });
    this.moving = false;
  }

  move(at) {
    if (!this.moving) {
      if (Math.hypot(at[0] - this.at[0], at[1] - this.at[1]) <= CLICK_TOLERANCE) return;
      if (!this.editor.beginDrag()) return;
      this.moving = true;
    }
    const to = this.overlay.unproject(...at, { through: this.through });
    if (to) this.editor.drag(to.map((value, axis) => value - this.from[axis]));
  }

  up(cancelled) {
    if (!this.moving) return;
    this.moving = false;
    if (cancelled) this.editor.cancelDrag();
    else this.editor.endDrag();
  }
}

class ToggleGesture {
  constructor(editor, index) {
    const { selected } = editor.draft;
    editor.select(selected.includes(index) ? selected.filter((i) => i !== index) : [...selected, index]);
  }

  move() {}

  up() {}
}

// A rectangle on the screen; the control points in it are added to the selection.
class BoxGesture {
  constructor(editor, overlay, at) {
    Object.assign(this, { editor, overlay, at, to: at });
    this.element = document.createElement("div");
    this.element.className = "selection-box";
    document.body.append(this.element);
    this.move(at);
  }

  move(to) {
    this.to = to;
    const [x, y] = [0, 1].map((axis) => Math.min(this.at[axis], to[axis]));
    const [width, height] = [0, 1].map((axis) => Math.abs(this.at[axis] - to[axis]));
    Object.assign(this.element.style, { left: `${x}px`, top: `${y}px`, width: `${width}px`, height: `${height}px` });
  }

  up(cancelled) {
    this.element.remove();
    if (cancelled) return;
    const inside = ([x, y]) =>
      [x, y].every(
        (value, axis) =>
          Math.min(this.at[axis], this.to[axis]) <= value && value <= Math.max(this.at[axis], this.to[axis]),
      );
    const found = this.editor.draft.curve.control_points.flatMap((point, i) => {
      const seen = this.overlay.project(point);
      return seen && inside(seen) ? [i] : [];
    });
    this.editor.select([...this.editor.draft.selected, ...found]);
  }
}
