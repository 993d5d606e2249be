// Arrows and plane handles on the selected control points: three's TransformControls, in the robot's axes.
import { TransformControls } from "../vendor/three/TransformControls.js";

export class Gizmo {
  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {import("./point_drag.js").PointDrag} drag
   */
  constructor(overlay, drag) {
    const { THREE, viewer } = overlay;
    this.overlay = overlay;
    this.anchor = new THREE.Object3D();
    overlay.group.add(this.anchor);
    this.controls = new TransformControls(viewer.camera, viewer.renderer.domElement);
    this.controls.setSpace("local"); // the anchor's axes are the robot's
    this.controls.setSize(0.75);
    overlay.worldGroup.add(this.controls);
    const start = new THREE.Vector3();
    this.controls.addEventListener("dragging-changed", ({ value }) => {
      overlay.lockCamera(value);
      if (value) start.copy(this.anchor.position);
      if (value) drag.begin();
      else drag.end();
    });
    this.controls.addEventListener("objectChange", () => drag.move(this.anchor.position.clone().sub(start).toArray()));
    this.controls.addEventListener("change", () => overlay.requestDraw());
  }

  /** Whether the pointer is on a handle. */
  get isHovered() {
    return this.controls.object !== undefined && this.controls.axis !== null;
  }

  get dragging() {
    return this.controls.dragging;
  }

  /**
   * Show the handles at a point; null: hide them.
   * @param {Point | null} point
   */
  attachTo(point) {
    if (this.dragging) return;
    if (point) {
      this.anchor.position.fromArray(point);
      this.controls.attach(this.anchor);
    } else this.controls.detach();
    this.overlay.requestDraw();
  }
}
