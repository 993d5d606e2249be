// A motion over time, that of a plan or of a past execution: where the arm is at any instant.

// {times, joints, gripper_closed?, object_position?, object_orientation?, segments?} as the service gives it.
export class Motion {
  constructor(rows) {
    this.rows = rows;
  }

  get duration() {
    return this.rows.times.at(-1) - this.rows.times[0];
  }

  // What the arm does at `seconds` from the beginning: {q, closed, position, orientation, segment}.
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

function normalize(quaternion) {
  const length = Math.hypot(...quaternion) || 1;
  return quaternion.map((value) => value / length);
}
