// The hand as the page moves it: it follows its target, never faster than a hand and never into the table.
import { distance } from "../polyline.js";

const MAX_SPEED = 1.2; // [m/s] the recorder takes anything faster for a jump of the tracker
const MAX_STEP = 0.03; // [s] that one step covers after a stall
const TIME_CONSTANT = 0.04; // [s] of the low-pass filter that smooths the steps of a mouse
const ARRIVAL_TOLERANCE = 0.004; // [m]

/**
 * @typedef {{kind: string, size: number[], position: Point}} Body
 * @typedef {{obstacles: (Body & {name: string})[], carried: Body}} Surroundings the scene, with the object at its start
 */

export class HandModel {
  grasped = false;
  tracked = true;

  /** @param {Surroundings} scene */
  constructor(scene) {
    this.scene = scene;
    this.home = [...scene.carried.position];
    this.position = [...this.home];
    this.target = [...this.home];
    this.halfHeight = halfHeight(scene.carried);
  }

  get isAtHome() {
    return distance(this.position, this.home) < ARRIVAL_TOLERANCE;
  }

  /**
   * Set where the hand goes; z stays above the table.
   * @param {Point} point
   */
  setTarget([x, y, z]) {
    /** @param {number} value @param {number} limit */
    const clamp = (value, limit) => Math.min(limit, Math.max(-limit, value));
    const [u, v] = [clamp(x, 1.4), clamp(y, 1.4)];
    this.target = [u, v, Math.min(2, Math.max(z, this.supportHeight([u, v]) + this.halfHeight))];
  }

  returnHome() {
    this.grasped = false;
    this.target = [...this.home];
  }

  /**
   * Advance by the seconds since the last step; true when the hand has moved.
   * @param {number} elapsed
   */
  step(elapsed) {
    const seconds = Math.min(elapsed, MAX_STEP);
    const share = 1 - Math.exp(-seconds / TIME_CONSTANT);
    const offset = this.target.map((value, i) => (value - this.position[i]) * share);
    const length = Math.hypot(...offset);
    const scale = length > MAX_SPEED * seconds ? (MAX_SPEED * seconds) / length : 1;
    this.position = this.position.map((value, i) => value + offset[i] * scale);
    return length > 1e-6;
  }

  /**
   * Height of the table under a place, or of the floor: what the object cannot be pushed into.
   * @param {number[]} place x and y
   */
  supportHeight([x, y]) {
    const table = this.scene.obstacles.find((shape) => shape.name === "table");
    return table && covers(table, x, y) ? top(table) : 0;
  }

  /**
   * Height of whatever lies under the object, for its shadow.
   * @param {Point} point
   */
  heightBelow([x, y, z]) {
    const under = this.scene.obstacles.filter((shape) => covers(shape, x, y) && top(shape) <= z + 0.001);
    return Math.max(0, ...under.map(top));
  }

  /**
   * Name of the obstacle that the object is in, or "".
   * @param {Point} point
   */
  collidingObstacle([x, y, z]) {
    const side = this.scene.carried.size[0] / 2;
    const hit = this.scene.obstacles.find(
      (shape) =>
        shape.name !== "table" &&
        covers(shape, x, y, side) &&
        z - this.halfHeight < top(shape) &&
        z + this.halfHeight > bottom(shape),
    );
    return hit?.name ?? "";
  }
}

/** @param {Body} shape */
const halfHeight = (shape) => (shape.kind === "cylinder" ? shape.size[1] : (shape.size[2] ?? shape.size[0])) / 2;
/** @param {Body} shape */
const top = (shape) => shape.position[2] + halfHeight(shape);
/** @param {Body} shape */
const bottom = (shape) => shape.position[2] - halfHeight(shape);

/** @param {Body} shape @param {number} x @param {number} y @param {number} margin */
function covers(shape, x, y, margin = 0) {
  const [dx, dy] = [Math.abs(x - shape.position[0]), Math.abs(y - shape.position[1])];
  if (shape.kind === "cylinder") return Math.hypot(dx, dy) < shape.size[0] + margin;
  return dx < shape.size[0] / 2 + margin && dy < shape.size[1] / 2 + margin;
}
