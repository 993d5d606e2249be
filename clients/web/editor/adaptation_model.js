// Predicts a path between another start and goal as the service does (learning/adaptation), so that a drag needs no network.
const DISTANCE_POWER = 0.8; // of the horizontal distance, by which shapes grow
const DISTANCE_SCALE = 0.7; // of the logarithm of a ratio of distances
const MIN_DISTANCE = 1e-6; // [m]
const SAME_CHORD = 0.02; // of the length of the learned path
const NUGGET = 1; // variance of the hand itself
const SINGLE_SPREAD = 0.12; // standard deviation after one demonstration, as share of the distance

/**
 * The points of the adapted path at equal arc lengths, and the standard deviation of a demonstration from each [m].
 * @param {AdaptationModel} model
 * @param {Point} start
 * @param {Point} goal
 */
export function predictPath(model, start, goal) {
  const chord = chordOf([start, goal]);
  const weights = krigingWeights(model, chord);
  const { points, scale } = krigedPoints(model, start, chord, weights);
  const own = closeness(model, chord);
  const edits = model.turns ? covariance(chord, chordOf(model.version)) : 1;
  for (const [k, point] of points.entries()) {
    for (let axis = 0; axis < 3; axis++) point[axis] += own * model.own[k][axis] + edits * model.edits[k][axis];
  }
  points[0] = [...start];
  points[points.length - 1] = [...goal];
  return { points, deviation: deviations(model, chord, weights, scale) };
}

/** @param {number[]} chord */
export const distanceOf = ([x, y]) => Math.hypot(x, y);

/** @param {number[]} chord */
export const yawOf = ([x, y]) => Math.atan2(y, x);

/** @param {number[][]} path */
export const chordOf = (path) => path[path.length - 1].map((value, axis) => value - path[0][axis]);

/** @param {number} yaw @param {number} distance @param {number} otherYaw @param {number} otherDistance */
function shapeCovariance(yaw, distance, otherYaw, otherDistance) {
  const turn = 2 * Math.sin((yaw - otherYaw) / 2);
  const [longer, shorter] = [distance, otherDistance].map((length) => Math.max(length, MIN_DISTANCE));
  const ratio = Math.log(longer / shorter) / DISTANCE_SCALE;
  return Math.exp(-(turn ** 2) / 2 - ratio ** 2 / 2);
}

/** @param {number[]} one @param {number[]} other chords */
const covariance = (one, other) => shapeCovariance(yawOf(one), distanceOf(one), yawOf(other), distanceOf(other));

/**
 * The weight of each demonstration, the multiplier of their sum, and the kriging variance last.
 * @param {AdaptationModel} model
 * @param {number[]} chord
 */
function krigingWeights({ turns, chords, inverse }, chord) {
  const known = chords.map((other) => (turns ? covariance(chord, other) : 1));
  known.push(1);
  const solved = inverse.map((row) => row.reduce((sum, value, i) => sum + value * known[i], 0));
  const explained = known.reduce((sum, value, i) => sum + value * solved[i], 0);
  return { weights: solved.slice(0, -1), unexplained: Math.max(1 + NUGGET - explained, 0) };
}

/**
 * @param {AdaptationModel} model
 * @param {Point} start
 * @param {number[]} chord
 * @param {{weights: number[]}} kriging
 */
function krigedPoints({ turns, chords, shapes }, start, chord, { weights }) {
  const yaw = yawOf(chord);
  const scale = turns ? distanceOf(chord) ** DISTANCE_POWER : 1;
  const last = shapes[0].length - 1;
  const points = shapes[0].map((_, k) => chord.map((value, axis) => start[axis] + (k / last) * value));
  for (const [i, shape] of shapes.entries()) {
    const weight = scale * weights[i];
    // The mean of the shape turned with the chord and of the shape kept in the world.
    const turn = turns ? yaw - yawOf(chords[i]) : 0;
    const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
    for (const [k, [x, y, z]] of shape.entries()) {
      points[k][0] += (weight * (cos * x - sin * y + x)) / 2;
      points[k][1] += (weight * (sin * x + cos * y + y)) / 2;
      points[k][2] += weight * z;
    }
  }
  return { points, scale };
}

/** How near a chord is to that of the learned path, 0 to 1. @param {AdaptationModel} model @param {number[]} chord */
function closeness({ learned }, chord) {
  const own = chordOf(learned);
  const separation = Math.hypot(...chord.map((value, axis) => value - own[axis]));
  let length = 0;
  for (let k = 1; k < learned.length; k++) {
    length += Math.hypot(...learned[k].map((value, axis) => value - learned[k - 1][axis]));
  }
  return Math.exp(-((separation / (SAME_CHORD * length)) ** 2) / 2);
}

/**
 * @param {AdaptationModel} model
 * @param {number[]} chord
 * @param {{unexplained: number}} kriging
 * @param {number} scale
 */
function deviations({ variance, version }, chord, { unexplained }, scale) {
  const last = version.length - 1;
  if (variance) return variance.map((value) => scale * Math.sqrt(unexplained * value));
  return version.map((_, k) => SINGLE_SPREAD * Math.hypot(...chord) * Math.sin((Math.PI * k) / last));
}
