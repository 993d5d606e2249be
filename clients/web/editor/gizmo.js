// Arrows and plane handles on the chosen control points: three's TransformControls, in the robot's axes.
import { TransformControls } from "../vendor/three/TransformControls.js";

export class Gizmo {
  // begin(), drag([dx, dy, dz]) since the beginning [m], end().
  constructor(easel, { begin, drag, end }) {
    const { THREE, viewer } = easel;
    this.easel = easel;
    this.anchor = new THREE.Object3D();
    easel.group.add(this.anchor);
    this.controls = new TransformControls(viewer.camera, viewer.renderer.domElement);
    this.controls.setSpace("local"); // the anchor's axes are the robot's
    this.controls.setSize(0.75);
    easel.gizmos.add(this.controls);
    const start = new THREE.Vector3();
    this.controls.addEventListener("dragging-changed", ({ value }) => {
      easel.hold(value);
      if (value) start.copy(this.anchor.position);
      (value ? begin : end)();
    });
    this.controls.addEventListener("objectChange", () => drag(this.anchor.position.clone().sub(start).toArray()));
    this.controls.addEventListener("change", () => easel.dirty());
  }

  // Whether the pointer is on a handle.
  get engaged() {
    return this.controls.object !== undefined && this.controls.axis !== null;
  }

  get dragging() {
    return this.controls.dragging;
  }

  // Stand at a point; null: be gone.
  place(point) {
    if (this.dragging) return;
    if (point) {
      this.anchor.position.set(...point);
      this.controls.attach(this.anchor);
    } else this.controls.detach();
    this.easel.dirty();
  }
}
