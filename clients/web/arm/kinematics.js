// Where the arm's links are, as the service computes it: poses to world from link 0, the world itself, to the flange.

/**
 * Compute a pose for each link, 16 numbers column by column, as three.js wants them.
 * @param {JointGeometry[]} joints as GET /robot gives them
 * @param {number[]} q [rad]
 */
export function linkFrames(joints, q) {
  const frames = [pose([0, 0, 0], [1, 0, 0, 0])];
  for (const [i, joint] of joints.entries()) {
    const { position, orientation } = joint;
    frames.push(multiply(multiply(frames[i], pose(position, orientation)), turn(joint, q[i])));
  }
  return frames;
}

/**
 * Compute the pose of the tool to world: 16 numbers column by column.
 * @param {Robot} arm as GET /robot gives it
 * @param {number[]} q [rad]
 */
export function toolPose(arm, q) {
  return multiply(linkFrames(arm.joints, q)[arm.joints.length], toolInFlange(arm));
}

/**
 * Compute the pose of the tool to the flange: 16 numbers column by column.
 * @param {Robot} arm as GET /robot gives it
 */
export function toolInFlange({ tool }) {
  return pose(tool.position, tool.orientation);
}

/**
 * Compute the pose of a position and a unit quaternion: 16 numbers column by column.
 * @param {number[]} position [m]
 * @param {number[]} orientation w, x, y, z
 */
function pose(position, [w, x, y, z]) {
  return [
    ...[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0],
    ...[2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0],
    ...[2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0],
    ...[...position, 1],
  ];
}

/**
 * Compute the motion of a link by an angle about its joint's axis.
 * @param {JointGeometry} joint
 * @param {number} angle [rad]
 */
function turn({ axis, anchor }, angle) {
  const [s, c] = [Math.sin(angle / 2), Math.cos(angle / 2)];
  const about = pose([0, 0, 0], [c, s * axis[0], s * axis[1], s * axis[2]]);
  const back = anchor.map((value) => -value);
  return multiply(multiply(pose(anchor, [1, 0, 0, 0]), about), pose(back, [1, 0, 0, 0]));
}

/** @param {number[]} left @param {number[]} right */
function multiply(left, right) {
  /** @type {number[]} */
  const made = new Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += left[4 * k + row] * right[4 * column + k];
      made[4 * column + row] = sum;
    }
  }
  return made;
}
