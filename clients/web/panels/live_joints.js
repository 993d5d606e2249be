// Live plots of the joints, while the panel is shown.
import { get } from "../api.js";
import { JointPlots, plotRow } from "../arm/joint_plots.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";

const WINDOW = 15; // [s]

/**
 * What the service tells of the arm, some 25 times a second while it moves, once a second while it rests.
 * @typedef {object} JointState
 * @property {number} stamp_ns
 * @property {number[]} position [rad]
 * @property {number[]} speed [rad/s]
 * @property {number | null} tracking_error [rad]
 * @property {number | null} lateness [s]
 * @property {boolean} gripper_closed
 * @property {ExecutorStatus | null} status
 */

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function liveJoints(place, { attempt }) {
  const plots = new JointPlots(place, { window: WINDOW });
  /** @type {Robot | undefined} */
  let arm;
  let begin = 0; // [s] of the first state
  /** @param {JointState} state */
  const plot = ({ stamp_ns, position, speed, tracking_error, lateness }) => {
    const seconds = stamp_ns / 1e9;
    begin ||= seconds;
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
