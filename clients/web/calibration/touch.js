// Where a place is that is touched: by the tool of the arm where it rests, or by a tracker that is held still.
import { get, post, resourcePath } from "../api.js";
import { toolPose } from "../arm/kinematics.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";

export const ARM_TOOL = "the arm's tool";
const TIMEOUT = 5000; // [ms] the service tells of the joints once a second
const REST_SPEED = 0.005; // [rad/s]

/**
 * @param {string} with_ a tracker, or ARM_TOOL
 * @returns {Promise<number[]>} in the tracker's frame, or in robot coordinates [m]
 */
export async function touch(with_) {
  if (with_ === ARM_TOOL) return toolPlace();
  /** @type {TouchedPlace} */
  const { position } = await post(resourcePath("trackers", with_, "touches"), {});
  return position;
}

/** @returns {Promise<number[]>} of the tool's centre point [m] */
async function toolPlace() {
  /** @type {[Robot, {position: number[], speed: number[]}]} */
  const [arm, { position, speed }] = await Promise.all([get("robot"), nextJointState()]);
  if (speed.some((value) => Math.abs(value) > REST_SPEED))
    throw new Error("The arm moves: let it rest at the place first.");
  return toolPose(arm, position).slice(12, 15);
}

/** @returns {Promise<{position: number[], speed: number[]}>} */
function nextJointState() {
  return new Promise((resolve, reject) => {
    const socket = new ReconnectingSocket("joints", {
      onMessage: (text) => {
        end();
        resolve(JSON.parse(text));
      },
    });
    const timer = setTimeout(() => {
      end();
      reject(new Error("The arm says nothing of its joints: is it connected?"));
    }, TIMEOUT);
    const end = () => {
      clearTimeout(timer);
      socket.close();
    };
    socket.open();
  });
}
