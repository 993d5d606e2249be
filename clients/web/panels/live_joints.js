// Live plots of the joints, while the panel is looked at.
import { get } from "../api.js";
import { JointStream } from "../arm/joint_state_stream.js";
import { Plots, row } from "../arm/joint_plots.js";

const WINDOW = 15; // [s]

export function live(place, { attempt }) {
  const plots = new Plots(place, { window: WINDOW });
  let arm = null;
  let begin = null; // [s] of the first frame
  const stream = new JointStream((frame) => {
    const seconds = frame.stamp_ns / 1e9;
    begin ??= seconds;
    if (arm) plots.add(row(arm, { time: seconds - begin, position: frame.position, speed: frame.speed, error: frame.tracking_error, lateness: frame.lateness }));
  });
  return {
    update() {},
    async show() {
      stream.start();
      arm ??= await attempt(() => get("robot"));
    },
    hide() {
      stream.stop();
    },
  };
}
