// A ghost arm: a pale copy of the drawn arm and of what it carries, posed by the page alone.
import { shapeGeometry } from "../meshes.js";
import { linkFrames, toolInFlange } from "./kinematics.js";

const COLOR = 0x2f7fb5;

/** @type {Record<string, number>} */
const FINGER_SIDES = { "left-finger": 1, "right-finger": -1 };

export class GhostArm {
  /** @type {THREE.Group[]} */
  #links = [];
  /** @type {{node: THREE.Group, side: number}[]} */
  #fingers = [];
  /** @type {THREE.Mesh | null} */
  #object = null;

  /**
   * @param {import("../overlay.js").Overlay} overlay
   * @param {import("../view.js").View} view
   * @param {Robot} arm
   * @param {Shape | null | undefined} carried the scene's object, if it has one
   */
  constructor(overlay, view, arm, carried) {
    const { THREE } = overlay;
    this.overlay = overlay;
    this.arm = arm;
    this.closing = toolInFlange(arm).slice(4, 7); // the axis along which the fingers close, in the flange's frame
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 }; // the arm, where both are in one place
    this.material = new THREE.MeshLambertMaterial({
      color: COLOR,
      transparent: true,
      opacity: 0.34,
      depthWrite: false,
      ...behind,
    });
    this.group = new THREE.Group();
    const robot = view.viewer.scene_tree.children.robot?.children ?? {};
    for (let i = 0; i <= arm.joints.length; i++) this.#links.push(this.#copy(robot[`link${i}`]));
    if (carried) {
      this.#object = new THREE.Mesh(shapeGeometry(carried), this.material);
      this.group.add(this.#object);
    }
    overlay.group.add(this.group);
  }

  /**
   * Show the arm at a configuration, its gripper open or closed, and the object at its pose, if there is one.
   * @param {import("./motion.js").MotionSample} sample
   */
  setPose({ q, closed, position, orientation }) {
    for (const [i, frame] of linkFrames(this.arm.joints, q).entries()) this.#links[i].matrix.fromArray(frame);
    for (const { node, side } of this.#fingers)
      node.position.fromArray(this.closing).multiplyScalar(closed ? 0 : side * this.arm.finger_travel);
    if (this.#object && position && orientation) {
      this.#object.position.fromArray(position);
      const [w, x, y, z] = orientation;
      this.#object.quaternion.set(x, y, z, w);
    }
    this.overlay.requestDraw();
  }

  /** Poses of the links as they are drawn, column by column, robot coordinates: for tests. */
  linkMatrices() {
    return this.#links.map((link) => link.matrix.toArray());
  }

  remove() {
    this.overlay.group.remove(this.group);
    this.#object?.geometry.dispose();
    this.material.dispose(); // the other shapes belong to the view
    this.overlay.requestDraw();
  }

  /** @param {MeshCatNode | undefined} node */
  #copy(node) {
    const link = new this.overlay.THREE.Group();
    link.matrixAutoUpdate = false;
    for (const [name, part] of Object.entries(node?.children ?? {})) {
      const copy = part.object.clone(true);
      copy.traverse((mesh) => {
        if (mesh instanceof this.overlay.THREE.Mesh)
          Object.assign(mesh, { material: this.material, castShadow: false, receiveShadow: false });
      });
      const side = FINGER_SIDES[name];
      const holder = new this.overlay.THREE.Group();
      if (side) {
        copy.position.set(0, 0, 0); // the view's own gripper may be open now
        copy.matrixAutoUpdate = true;
        this.#fingers.push({ node: holder, side });
      }
      holder.add(copy);
      link.add(holder);
    }
    this.group.add(link);
    return link;
  }
}
