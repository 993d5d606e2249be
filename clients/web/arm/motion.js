// A motion against time, a plan's or that of a past execution: where the arm is at any instant, and playing it.

// {times, joints, gripper_closed?, object_position?, object_orientation?, segments?} as the service gives it.
export class Motion {
  constructor(rows) {
    this.rows = rows;
  }

  get duration() {
    return this.rows.times.at(-1) - this.rows.times[0];
  }

  // What the arm does at `seconds` from the beginning: {q, closed, position, orientation, words}.
  at(seconds) {
    const { times, joints, gripper_closed: closed, object_position: places, object_orientation: turns, segments } = this.rows;
    const time = times[0] + Math.max(0, Math.min(seconds, this.duration));
    const [low, share] = between(times, time);
    const high = Math.min(low + 1, times.length - 1);
    const mixed = (rows) => rows[low].map((value, i) => value + share * (rows[high][i] - value));
    return {
      q: mixed(joints),
      closed: closed?.[low] ?? false,
      position: places?.length ? mixed(places) : null,
      orientation: turns?.length ? unit(mixed(turns)) : null,
      words: segments?.findLast((segment) => segment.begin <= time)?.name ?? "",
    };
  }
}

function between(times, time) {
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  const span = times[high] - times[low];
  return [low, span > 0 ? (time - times[low]) / span : 0];
}

function unit(quaternion) {
  const length = Math.hypot(...quaternion) || 1;
  return quaternion.map((value) => value / length);
}
