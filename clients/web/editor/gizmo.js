// Arrows with the letters of their axes and plane handles on what is selected: three's TransformControls.
import { textSprite } from "../text_sprite.js";
import { TransformControls } from "../vendor/three/TransformControls.js";

const AXIS_COLORS = ["#ff8a80", "#9be59b", "#9db8ff"];
const [LETTER_SIZE, LETTER_PLACE] = [0.16, 0.66]; // an arrow is half as long as these are counted

export class Gizmo {
  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {{begin(): unknown, move(by: number[]): void, end(): void}} drag what is dragged: by so much since it began [m]
   */
  constructor(overlay, drag) {
    const { THREE, viewer } = overlay;
    this.overlay = overlay;
    this.anchor = new THREE.Object3D();
    overlay.group.add(this.anchor);
    this.controls = new TransformControls(viewer.camera, viewer.renderer.domElement);
    this.controls.setSpace("local"); // the anchor's axes are the robot's
    this.controls.setSize(0.75);
    this.#writeLetters();
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

  /** Letters at the tips of the arrows: parts of these, they are shown, turned and scaled with them. */
  #writeLetters() {
    for (const [k, axis] of ["X", "Y", "Z"].entries()) {
      const letter = textSprite(axis.toLowerCase(), { color: AXIS_COLORS[k], sizeAttenuation: true });
      letter.scale.multiplyScalar(LETTER_SIZE);
      letter.position.setComponent(k, LETTER_PLACE);
      this.controls.getObjectByName(axis)?.add(letter); // the arrow: it comes before what is picked by it
    }
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
