// Draws where an adapted path begins and ends, as balls to drag, and the path between them.
const RADIUS = 0.022; // [m]
const PICK_RADIUS = 22; // [px]
const PATH_COLOR = 0x0f8a5f;

/** @typedef {"start" | "goal"} End */

export const ENDS = /** @type {const} */ (["start", "goal"]);

export class TargetOverlay {
  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {THREE.Group} parent is visible with the editor
   */
  constructor(overlay, parent) {
    const { THREE } = overlay;
    this.overlay = overlay;
    this.group = new THREE.Group();
    this.group.visible = false;
    const ball = new THREE.SphereGeometry(RADIUS, 24, 16);
    /** @param {THREE.ColorRepresentation} color */
    const handle = (color) =>
      new THREE.Mesh(ball, new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.8 }));
    this.handles = { start: handle(0xe8a317), goal: handle(PATH_COLOR) };
    this.group.add(this.handles.start, this.handles.goal);
    parent.add(this.group);
  }

  hide() {
    this.group.visible = false;
    this.overlay.setLine("edit-adapted", null);
  }

  /**
   * Called in every frame of a drag.
   * @param {Point[]} points from start to goal
   */
  draw(points) {
    this.group.visible = true;
    this.handles.start.position.fromArray(points[0]);
    this.handles.goal.position.fromArray(points[points.length - 1]);
    this.overlay.setLine("edit-adapted", points, { color: PATH_COLOR, opacity: 1 });
  }

  /**
   * The ball under a pixel, or null.
   * @param {Record<End, Point>} ends
   * @param {number[]} pixel
   */
  pick(ends, [x, y]) {
    const seen = ENDS.map((end) => ({ end, at: this.overlay.project(ends[end]) }));
    const near = seen.map(({ end, at }) => ({ end, off: at ? Math.hypot(at[0] - x, at[1] - y) : Infinity }));
    const best = near[0].off <= near[1].off ? near[0] : near[1];
    return best.off <= PICK_RADIUS ? best.end : null;
  }
}
