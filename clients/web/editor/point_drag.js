// A drag of the selected control points: drawn once a frame, and one step of the draft when it ends.
import { ChangeLabel } from "./change_label.js";
import { movePoints } from "./curve_edits.js";

export class PointDrag {
  /** @type {{curve: Curve, indices: number[], by: number[]} | null} */
  #drag = null; // the curve it began with, the points that move, by how much [m]
  #frame = 0;

  /** @param {import("./editor.js").Editor} editor */
  constructor(editor) {
    this.editor = editor;
    this.label = new ChangeLabel(editor.overlay);
  }

  get active() {
    return this.#drag !== null;
  }

  /** False when no selected control point may be moved. */
  begin() {
    const { draft, context, curveOverlay } = this.editor;
    if (!draft) return false;
    const { movable: indices, selected, curve } = draft;
    if (!indices.length) {
      const pinned = "Start and goal are pinned. Unlock them to move them.";
      context.messages.show(selected.length ? pinned : "Choose a control point first.");
      return false;
    }
    draft.beginDrag();
    this.#drag = { curve, indices, by: [0, 0, 0] };
    curveOverlay.setColors(null);
    return true;
  }

  /**
   * Move the points by so much since the drag began [m]; drawn once, in the next frame.
   * @param {number[]} by
   */
  move(by) {
    if (!this.#drag) return;
    this.#drag.by = by;
    this.#frame ||= requestAnimationFrame(() => this.#redraw());
  }

  end() {
    if (!this.#drag) return;
    const { indices } = this.#drag;
    this.#redraw();
    this.#drag = null;
    this.label.hide();
    const points = indices.length === 1 ? `control point ${indices[0] + 1}` : `${indices.length} control points`;
    this.editor.draft?.endDrag(`moving ${points}`);
    this.editor.curveChanged();
  }

  cancel() {
    this.#drag = null;
    this.label.hide();
    this.editor.draft?.cancelDrag();
    this.editor.curveChanged();
  }

  #redraw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    const { draft, timings, context } = this.editor;
    const drag = this.#drag;
    if (!drag || !draft) return;
    timings.measureFrame(() => {
      draft.preview(movePoints(drag.curve, drag.indices, drag.by));
      this.editor.curveDragged();
    }, context.view);
    if (this.editor.selectionCenter) this.label.show(drag.by, this.editor.selectionCenter);
  }
}
