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
 * @property {number | null} gripper_opening [m] measured between the fingers; null where the arm does not measure it
 * @property {string} output name of the one that is on; "" is none
 * @property {boolean} enabled whether the drives are on
 * @property {boolean} protective_stop whether the arm's own controller has stopped it
 * @property {string} fault of the arm; "" is none
 * @property {ExecutorStatus | null} status
 */

/**
 * @param {HTMLElement} place
 * @param {Context} context
 * @param {(state: JointState) => void} onState called with each of them
 * @returns {Section}
 */
export function liveJoints(place, { attempt }, onState) {
  /** @type {Robot | undefined} */
  let arm;
  /** @type {JointPlots | undefined} */
  let plots;
  let begin = 0; // [s] of the first state
  /** @param {JointState} state */
  const plot = ({ stamp_ns, position, speed, tracking_error, lateness }) => {
    const seconds = stamp_ns / 1e9;
    begin ||= seconds;
    if (!arm) return;
    plots ??= new JointPlots(place, arm, { window: WINDOW });
    plots.append(plotRow(arm, { time: seconds - begin, position, speed, error: tracking_error, lateness }));
  };
  /** @param {JointState} state */
  const receive = (state) => {
    plot(state);
    onState(state);
  };
  const socket = new ReconnectingSocket("joints", { onMessage: (text) => receive(JSON.parse(text)) });
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
