// Orientations as a person writes them: degrees about the robot's x, then y, then z.
const DEGREE = Math.PI / 180;

/** @param {number[]} orientation unit quaternion w, x, y, z @returns {number[]} degrees about x, y, z; y from -90 to 90 */
export function turnsOf([w, x, y, z]) {
  const sine = 2 * (w * y - z * x);
  if (Math.abs(sine) > 1 - 1e-9) return [0, Math.sign(sine) * 90, (-Math.sign(sine) * 2 * Math.atan2(x, w)) / DEGREE]; // x and z turn alike
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) / DEGREE,
    Math.asin(sine) / DEGREE,
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) / DEGREE,
  ];
}

/** @param {number[]} turns degrees about x, then y, then z @returns {[number, number, number, number]} unit quaternion w, x, y, z */
export function orientationOf(turns) {
  const [[cx, sx], [cy, sy], [cz, sz]] = turns.map((turn) => [
    Math.cos((turn * DEGREE) / 2),
    Math.sin((turn * DEGREE) / 2),
  ]);
  return [
    cx * cy * cz + sx * sy * sz,
    sx * cy * cz - cx * sy * sz,
    cx * sy * cz + sx * cy * sz,
    cx * cy * sz - sx * sy * cz,
  ];
}
