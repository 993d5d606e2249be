// Draws what the operator carries: the object, its shadow on what lies below, and a line between the two that shows the
// height.
import { shapeGeometry } from "../meshes.js";

const COLOR_FREE = 0xe8c547;
const COLOR_GRASPED = 0xe08a00;
const COLOR_COLLIDING = 0xb3391f;

export class CarriedObject {
  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {import("../meshes.js").Solid} shape the carried object of the scene
   */
  constructor(overlay, shape) {
    const { THREE } = overlay;
    this.overlay = overlay;
    this.group = new THREE.Group();
    const material = new THREE.MeshLambertMaterial({ color: COLOR_FREE });
    this.body = new THREE.Mesh(shapeGeometry(shape), material);
    this.body.castShadow = true;
    const dark = { color: 0x101418, transparent: true, depthWrite: false };
    this.disc = new THREE.Mesh(
      new THREE.CircleGeometry(Math.max(...shape.size) * 0.75, 32),
      new THREE.MeshBasicMaterial({ ...dark, opacity: 0.35 }),
    );
    const line = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3(0, 0, 1)]);
    this.stem = new THREE.Line(line, new THREE.LineBasicMaterial({ color: 0x5a6672 }));
    this.group.add(this.body, this.disc, this.stem);
    overlay.group.add(this.group);
  }

  /**
   * Show it at a position, in the colour of its state.
   * @param {Point} position
   * @param {number} floor height of what is below [m]
   * @param {{grasped: boolean, colliding: boolean}} state
   */
  setPosition([x, y, z], floor, { grasped, colliding }) {
    this.body.position.set(x, y, z);
    this.disc.position.set(x, y, floor + 0.002);
    this.stem.position.set(x, y, floor);
    this.stem.scale.z = Math.max(1e-4, z - floor);
    this.body.material.color.setHex(colliding ? COLOR_COLLIDING : grasped ? COLOR_GRASPED : COLOR_FREE);
    this.overlay.requestDraw();
  }

  /**
   * Turn it as the hand that holds it; null: upright.
   * @param {THREE.Quaternion | null} turn
   */
  setOrientation(turn) {
    this.body.quaternion.copy(turn ?? new this.overlay.THREE.Quaternion());
  }

  remove() {
    this.overlay.group.remove(this.group);
    for (const mesh of [this.body, this.disc, this.stem]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.overlay.requestDraw();
  }
}
