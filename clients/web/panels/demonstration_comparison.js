// Two demonstrations on one axis of time, and what lies between them; and a trim, from times to the samples of a recording.

const POINTS = 200; // of the common axis

/** @typedef {{times: number[], positions: Point[]}} Motion times from 0 [s], strictly increasing; positions [m, world] */

/**
 * Where a motion is at a time; null: it has not begun, or has ended.
 * @param {Motion} motion
 * @param {number} time [s]
 * @returns {Point | null}
 */
export function positionAt({ times, positions }, time) {
  const last = times.length - 1;
  if (last < 0 || time < times[0] || time > times[last]) return null;
  const after = times.findIndex((each) => each >= time);
  if (after === 0 || times[after] === time) return positions[after];
  const share = (time - times[after - 1]) / (times[after] - times[after - 1]);
  return positions[after].map((end, axis) => positions[after - 1][axis] + share * (end - positions[after - 1][axis]));
}

/** A motion on the share of its own time, from 0 to 100. @param {Motion} motion @returns {Motion} */
export function overShare({ times, positions }) {
  const end = times.at(-1) || 1;
  return { times: times.map((time) => (100 * time) / end), positions };
}

/**
 * Both motions at the same times, and how far apart they are; null where one of them is not under way.
 * @param {Motion} one
 * @param {Motion} other
 */
export function compareMotions(one, other) {
  const end = Math.max(one.times.at(-1) ?? 0, other.times.at(-1) ?? 0);
  const times = Array.from({ length: POINTS }, (_, k) => (k === POINTS - 1 ? end : (end * k) / (POINTS - 1)));
  const places = [one, other].map((motion) => times.map((time) => positionAt(motion, time)));
  const distances = times.map((_, k) => {
    const [here, there] = [places[0][k], places[1][k]];
    return here && there && Math.hypot(...here.map((value, axis) => value - there[axis]));
  });
  const known = distances.flatMap((distance) => (distance === null ? [] : [distance]));
  const largest = Math.max(0, ...known);
  return {
    times,
    places,
    distances,
    largest,
    largestAt: times[distances.indexOf(largest)] ?? 0,
    mean: known.reduce((sum, distance) => sum + distance, 0) / Math.max(1, known.length),
  };
}

/**
 * The samples of a recording to which a demonstration is trimmed: [begin, end), as the service takes them.
 * @param {Pick<Demonstration, "trim" | "grasp" | "release">} demonstration as it is cut now
 * @param {number[]} times of its motion, as it is cut now [s]
 * @param {{grasp: number, release: number}} marks from where to where it is to go [s]
 * @returns {[number, number]}
 */
export function trimmedSamples({ trim, grasp, release }, times, marks) {
  const [begin, end] = trim ?? [grasp, release];
  /** @param {number} time the number of the nearest sample */
  const sampleAt = (time) => {
    const after = times.findIndex((each) => each >= time);
    const place = after < 0 ? times.length - 1 : after;
    const isBefore = place > 0 && time - times[place - 1] < times[place] - time;
    return begin + Math.round(((isBefore ? place - 1 : place) * (end - 1 - begin)) / Math.max(1, times.length - 1));
  };
  return [sampleAt(marks.grasp), sampleAt(marks.release) + 1];
}
