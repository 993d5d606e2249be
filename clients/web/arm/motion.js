// A motion over time, that of a plan or of a past execution: where the arm is at any instant.

/**
 * @typedef {Pick<MotionPreview, "times" | "joints"> & Partial<MotionPreview>} MotionRows
 *
 * What the arm does at one instant: configuration [rad], gripper, pose of the object (orientation w, x, y, z) and words.
 * @typedef {object} MotionSample
 * @property {number[]} q
 * @property {boolean} closed
 * @property {Point | null} position
 * @property {number[] | null} orientation
 * @property {string} segment
 */

export class Motion {
  /** @param {MotionRows} rows as the service gives them */
  constructor(rows) {
    this.rows = rows;
  }

  get duration() {
    const { times } = this.rows;
    return times[times.length - 1] - times[0];
  }

  /**
   * @param {number} seconds from the beginning
   * @returns {MotionSample}
   */
  sample(seconds) {
    const {
      times,
      joints,
      gripper_closed: closed,
      object_position: places,
      object_orientation: turns,
      segments,
    } = this.rows;
    const time = times[0] + Math.max(0, Math.min(seconds, this.duration));
    const [low, share] = findInterval(times, time);
    const high = Math.min(low + 1, times.length - 1);
    /** @param {number[][]} rows */
    const interpolated = (rows) => rows[low].map((value, i) => value + share * (rows[high][i] - value));
    return {
      q: interpolated(joints),
      closed: closed?.[low] ?? false,
      position: places?.length ? interpolated(places) : null,
      orientation: turns?.length ? normalize(interpolated(turns)) : null,
      segment: segments?.findLast((one) => one.begin <= time)?.name ?? "",
    };
  }
}

/**
 * The row before a time, and the share of the way to the next.
 * @param {number[]} times
 * @param {number} time
 */
function findInterval(times, time) {
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  const span = times[high] - times[low];
  return [low, span > 0 ? (time - times[low]) / span : 0];
}

/** @param {number[]} quaternion */
function normalize(quaternion) {
  const length = Math.hypot(...quaternion) || 1;
  return quaternion.map((value) => value / length);
}
