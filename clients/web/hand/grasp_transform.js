// The object stays in the hand as it was grasped.

/** @typedef {Pick<Hand, "position" | "orientation">} HandPose */

/**
 * Returns what maps a later pose of the hand to that of the object, {position, turn}.
 * @param {HandPose} hand when it grasps
 * @param {Point} home where the object is then, upright
 */
export function graspTransform(hand, home) {
  const { THREE } = globalThis.MeshCat;
  const back = quaternion(hand.orientation).invert();
  const away = new THREE.Vector3().fromArray(home).sub(new THREE.Vector3().fromArray(hand.position));
  /** @param {HandPose} later */
  return (later) => {
    const turn = quaternion(later.orientation).multiply(back);
    const position = away.clone().applyQuaternion(turn).add(new THREE.Vector3().fromArray(later.position));
    return { position: position.toArray(), turn };
  };
}

/** @param {number[] | null} orientation w, x, y, z; null: upright */
function quaternion(orientation) {
  const [w, x, y, z] = orientation ?? [1, 0, 0, 0];
  return new globalThis.MeshCat.THREE.Quaternion(x, y, z, w);
}
