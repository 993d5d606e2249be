// The pointer on the control points: choose, drag in the plane of the picture, choose with a box.
const NEAR = 12; // [px]
const STILL = 3; // [px] that a click may move

// `editor` offers draft, choose(indices), begin(), drag(by), end(what), abandon(); `gizmo` comes first.
export function grab(editor, easel, gizmo) {
  let gesture = null;

  const down = (event) => {
    if (!editor.active || event.button !== 0 || gizmo.engaged) return false;
    const at = [event.clientX, event.clientY];
    const index = nearest(editor.draft.curve.control_points, easel, at);
    if (index === null && !event.shiftKey) return false; // the camera's
    easel.element.focus({ preventScroll: true });
    if (index === null) gesture = new Box(editor, easel, at);
    else if (event.shiftKey) gesture = new Toggle(editor, index);
    else gesture = new Drag(editor, easel, index, at);
    return true;
  };
  easel.capture({ down, move: (event) => gesture?.move([event.clientX, event.clientY]), up: (event) => gesture?.up(event === null) });
}

function nearest(points, easel, [x, y]) {
  let best = null;
  let least = NEAR;
  points.forEach((point, i) => {
    const seen = easel.project(point);
    const off = seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity;
    if (off <= least) [best, least] = [i, off];
  });
  return best;
}

class Drag {
  constructor(editor, easel, index, at) {
    Object.assign(this, { editor, easel, at });
    if (!editor.draft.chosen.includes(index)) editor.choose([index]);
    this.through = editor.draft.curve.control_points[index];
    this.from = easel.unproject(...at, { through: this.through });
    this.moving = false;
  }

  move(at) {
    if (!this.moving) {
      if (Math.hypot(at[0] - this.at[0], at[1] - this.at[1]) <= STILL) return;
      if (!this.editor.begin()) return;
      this.moving = true;
    }
    const to = this.easel.unproject(...at, { through: this.through });
    if (to) this.editor.drag(to.map((value, axis) => value - this.from[axis]));
  }

  up(broken) {
    if (!this.moving) return;
    this.moving = false;
    if (broken) this.editor.abandon();
    else this.editor.end();
  }
}

class Toggle {
  constructor(editor, index) {
    const { chosen } = editor.draft;
    editor.choose(chosen.includes(index) ? chosen.filter((i) => i !== index) : [...chosen, index]);
  }

  move() {}

  up() {}
}

// A rectangle on the screen; what lies in it is added to what is chosen.
class Box {
  constructor(editor, easel, at) {
    Object.assign(this, { editor, easel, at, to: at });
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

  up(broken) {
    this.element.remove();
    if (broken) return;
    const inside = ([x, y]) => [x, y].every((value, axis) => Math.min(this.at[axis], this.to[axis]) <= value && value <= Math.max(this.at[axis], this.to[axis]));
    const found = this.editor.draft.curve.control_points.flatMap((point, i) => {
      const seen = this.easel.project(point);
      return seen && inside(seen) ? [i] : [];
    });
    this.editor.choose([...this.editor.draft.chosen, ...found]);
  }
}
