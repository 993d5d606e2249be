// Moves the chosen shape of a scene by arrows in the view: drawn once a frame, and one step of the draft when it ends.
import { ChangeLabel } from "../editor/change_label.js";
import { Gizmo } from "../editor/gizmo.js";

export class ShapeDrag {
  /** @type {{shape: Shape, by: number[]} | null} */
  #drag = null; // the shape as it was when the drag began, and how far it has come since [m]
  #frame = 0;
  /** @type {Shape | null} */
  #shape = null;

  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {{preview: (shape: Shape) => void, change: (shape: Shape, what: string) => void}} editor
   */
  constructor(overlay, editor) {
    this.editor = editor;
    this.label = new ChangeLabel(overlay);
    this.gizmo = new Gizmo(overlay, this);
  }

  /** Let a shape be moved; null: none. @param {Shape | null} shape */
  show(shape) {
    this.#shape = shape;
    this.gizmo.attachTo(shape?.position ?? null);
  }

  begin() {
    this.#drag = this.#shape && { shape: this.#shape, by: [0, 0, 0] };
  }

  /** @param {number[]} by [m] since the drag began */
  move(by) {
    if (!this.#drag) return;
    this.#drag.by = by;
    this.#frame ||= requestAnimationFrame(() => this.#redraw());
  }

  end() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.label.hide();
    const drag = this.#drag;
    this.#drag = null;
    if (drag?.by.some((value) => value !== 0)) this.editor.change(moved(drag), `moving ${drag.shape.name}`);
  }

  #redraw() {
    this.#frame = 0;
    if (!this.#drag) return;
    const shape = moved(this.#drag);
    this.editor.preview(shape);
    this.label.show(this.#drag.by, shape.position);
  }
}

/** @param {{shape: Shape, by: number[]}} drag @returns {Shape} */
const moved = ({ shape, by: [dx, dy, dz] }) => {
  const [x, y, z] = shape.position;
  return { ...shape, position: [rounded(x + dx), rounded(y + dy), rounded(z + dz)] };
};

/** To a tenth of a millimetre, which nobody places a thing more exactly than. @param {number} metres */
const rounded = (metres) => Math.round(1e4 * metres) / 1e4;
