// The numbers of the control points in the view: those of all while they are few, else of the selected ones.
import { textSprite } from "../text_sprite.js";

const FULL_NUMBERING_LIMIT = 24; // control points
const NUMBERING_LIMIT = 60; // numbers are no help beyond
const SIZE = 0.024; // share of the picture's height

export class PointNumbers {
  /** @type {Map<number, THREE.Sprite>} */
  #sprites = new Map(); // by the index of the point

  /** @param {THREE.Group} group */
  constructor(group) {
    this.group = group;
  }

  /** @param {Point[]} points called in every frame of a drag */
  move(points) {
    for (const [index, sprite] of this.#sprites) if (points[index]) sprite.position.fromArray(points[index]);
  }

  /** @param {import("./draft.js").Draft} draft */
  choose(draft) {
    const points = draft.curve.control_points;
    const wanted = new Set(numberedPoints(points.length, draft.selected));
    for (const [index, sprite] of this.#sprites) sprite.visible = wanted.has(index);
    for (const index of wanted) {
      if (!this.#sprites.has(index)) this.#sprites.set(index, this.#create(index));
    }
    this.move(points);
  }

  /** @param {number} index */
  #create(index) {
    const sprite = textSprite(String(index + 1));
    sprite.scale.multiplyScalar(SIZE);
    sprite.center.set(0.5, -0.45); // above the point
    this.group.add(sprite);
    return sprite;
  }
}

/**
 * Indices of the points whose numbers are shown.
 * @param {number} count of all points
 * @param {number[]} selected
 */
export function numberedPoints(count, selected) {
  if (count <= FULL_NUMBERING_LIMIT) return Array.from({ length: count }, (_, index) => index);
  return selected.length <= NUMBERING_LIMIT ? selected : [];
}
