// Where the arm's links are, as the service computes it: standard Denavit-Hartenberg, poses to world from link 0 to 6.

/**
 * Compute 7 poses, each 16 numbers column by column, as three.js wants them.
 * @param {LinkGeometry[]} links as GET /robot gives them
 * @param {number[]} q [rad]
 */
export function linkFrames(links, q) {
  const frames = [identity()];
  for (const [i, link] of links.entries()) frames.push(multiply(frames[i], denavitHartenberg(q[i], link)));
  return frames;
}

/** @param {number} angle @param {LinkGeometry} link */
function denavitHartenberg(angle, { d, a, alpha }) {
  const [c, s, ca, sa] = [Math.cos(angle), Math.sin(angle), Math.cos(alpha), Math.sin(alpha)];
  return [c, s, 0, 0, -s * ca, c * ca, sa, 0, s * sa, -c * sa, ca, 0, a * c, a * s, d, 1];
}

function identity() {
  return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
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
