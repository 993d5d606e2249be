// Says of a path between another start and goal whether it is within what was shown, as the service says it (learning/adaptation).
import { formatLength } from "../texts.js";
import { chordOf, distanceOf, yawOf } from "./adaptation_model.js";

const MIN_DISTANCE_SHARE = 0.25; // of the length, within which closed and vertical paths are as shown
const MAX_DISTANCE_RATIO = 1.5; // to the shown distances
const MAX_RISE_SHARE = 0.25; // of the largest shown distance
const MAX_TURN = Math.PI / 3; // [rad] from the nearest shown direction

/**
 * How sure a path between these ends is, in a sentence.
 * @param {AdaptationModel} model
 * @param {Point} start
 * @param {Point} goal
 * @param {number[]} deviation of a demonstration from each point [m]
 */
export function describeCertainty(model, start, goal, deviation) {
  if (model.places === 1)
    return "Shown at one place only: the shape is kept, and how it changes with the place is not known.";
  const beyond = beyondShown(model, start, goal);
  if (beyond) return `Beyond what was shown: ${beyond}.`;
  const within = formatLength(2 * Math.max(...deviation));
  return `Someone who shows it between these ends would stay within ${within} of it, nineteen times of twenty.`;
}

/**
 * What is beyond the shown range; empty within it.
 * @param {AdaptationModel} model
 * @param {Point} start
 * @param {Point} goal
 */
export function beyondShown(model, start, goal) {
  const chord = chordOf([start, goal]);
  return model.turns ? turningBeyond(model.chords, chord) : closedBeyond(model, chord);
}

/** @param {AdaptationModel} model @param {number[]} chord */
function closedBeyond({ chords, length }, chord) {
  const separation = Math.min(...chords.map((shown) => Math.hypot(...shown.map((value, axis) => value - chord[axis]))));
  return separation > MIN_DISTANCE_SHARE * length
    ? `from start to goal it is ${formatLength(separation)} otherwise than shown`
    : "";
}

/** @param {number[][]} chords that were shown @param {number[]} chord */
function turningBeyond(chords, chord) {
  const [nearest, farthest] = range(chords.map(distanceOf));
  const distance = distanceOf(chord);
  if (distance < nearest / MAX_DISTANCE_RATIO || distance > farthest * MAX_DISTANCE_RATIO) {
    const shown = span(formatLength(nearest), formatLength(farthest));
    return `start and goal are ${formatLength(distance)} apart on the level, shown were ${shown}`;
  }
  const [lowest, highest] = range(chords.map(([, , rise]) => rise));
  const allowed = MAX_RISE_SHARE * farthest;
  if (chord[2] < lowest - allowed || chord[2] > highest + allowed)
    return `the goal is ${formatRise(chord[2])} than the start, shown were ${span(formatRise(lowest), formatRise(highest))}`;
  const turn = Math.min(...chords.map((shown) => angleBetween(yawOf(chord), yawOf(shown))));
  return turn > MAX_TURN
    ? `the direction is ${Math.round((180 * turn) / Math.PI)}° from the nearest one that was shown`
    : "";
}

/** @param {number[]} values @returns {[number, number]} */
const range = (values) => [Math.min(...values), Math.max(...values)];

/** @param {number} one @param {number} other [rad] */
const angleBetween = (one, other) => Math.acos(Math.cos(one - other));

/** @param {number} height [m] */
const formatRise = (height) => `${formatLength(Math.abs(height))} ${height >= 0 ? "higher" : "lower"}`;

/** @param {string} least @param {string} most */
const span = (least, most) => (least === most ? least : `${least} to ${most}`);
