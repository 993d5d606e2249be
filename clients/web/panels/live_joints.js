// Live plots of the joints, while the panel is shown.
import { get } from "../api.js";
import { JointPlots, plotRow } from "../arm/joint_plots.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";

const WINDOW = 15; // [s]

export function liveJoints(place, { attempt }) {
  const plots = new JointPlots(place, { window: WINDOW });
  let arm = null;
  let begin = null; // [s] of the first state
  const plot = ({ stamp_ns, position, speed, tracking_error, lateness }) => {
    const seconds = stamp_ns / 1e9;
    begin ??= seconds;
    if (arm) plots.append(plotRow(arm, { time: seconds - begin, position, speed, error: tracking_error, lateness }));
  };
  const socket = new ReconnectingSocket("joints", { onMessage: (text) => plot(JSON.parse(text)) });
  return {
    update() {},
    async show() {
      socket.open();
      arm ??= await attempt(() => get("robot"));
    },
    hide() {
      socket.close();
    },
  };
}
