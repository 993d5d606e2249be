// The web worker of sample_sender.js: samples the hand at the pose that the page posted last, at a fixed rate whatever the
// page is doing, and sends the samples.

import { FixedRateTimer } from "./fixed_rate_timer.js";
import { clock, TrackerSocket } from "./tracker_socket.js";

const POSE_TIMEOUT = 2000; // [ms] without a pose, after which the hand counts as not tracked; until then it stands still
const MAX_STEP = 0.036; // [m] between two samples; the recorder takes more for a jump of the tracker
const STATUS_EVERY = 15; // samples between two messages about the status

/**
 * @typedef {object} WorkerMessage
 * @property {import("./sample_sender.js").SenderStatus} status
 * @property {string} [state]
 * @property {string} [sentence]
 * @property {string} [rejected]
 * @property {number} [number] of the request that is answered
 * @property {unknown} [value]
 * @property {string} [error]
 */

/** @type {TrackerSocket | null} */
let socket = null;
/** @type {Hand | null} */
let hand = null; // as the page last posted it
let posted = 0; // [ms] when that was
/** @type {Hand | null} */
let newest = null; // of the last sample

const timer = new FixedRateTimer(() => {
  if (!hand) return;
  newest = stepTowards(newest ?? hand, hand);
  send({ ...newest, tracked: hand.tracked && performance.now() - posted < POSE_TIMEOUT, ms: clock() });
});

/**
 * A step of at most MAX_STEP towards the page's pose; grasp and release wait for its end, releasing the clutch does not.
 * @param {Hand} from
 * @param {Hand} to
 */
function stepTowards(from, to) {
  const offset = to.position.map((value, i) => value - from.position[i]);
  const length = Math.hypot(...offset);
  if (length <= MAX_STEP) return to;
  return {
    ...from,
    clutch: from.clutch && to.clutch,
    position: from.position.map((value, i) => value + (offset[i] * MAX_STEP) / length),
  };
}

addEventListener("message", async ({ data }) => {
  const { name, session, pose, sample, order, number } = data;
  if (name)
    socket = new TrackerSocket(name, session, {
      onChange: (state, sentence) => postStatus({ state, sentence }),
      onRejected: (rejected) => postStatus({ rejected }),
    });
  if (pose) {
    [hand, posted] = [pose, performance.now()];
    timer.start();
  }
  if (sample) {
    timer.stop();
    newest = null;
    send(sample);
  }
  if (order === "close") {
    socket?.close();
    close();
  } else if (order) await answer(number, order === "connect" ? () => socket?.connect() : () => end(data));
});

/**
 * Sampling stops first: the report's last number is the last that was sent.
 * @param {{discard: boolean}} options
 */
function end({ discard }) {
  timer.stop();
  return socket?.end({ discard });
}

/** @param {HandSample} sample */
function send(sample) {
  if (!socket) return;
  socket.send(sample);
  if (socket.sequence % STATUS_EVERY === 0) postStatus({});
}

/** @param {Partial<WorkerMessage>} message */
function postStatus(message) {
  if (!socket) return;
  const { live, offset, dropped, sequence } = socket;
  postMessage({ ...message, status: { live, offset, dropped, sequence } });
}

/** @param {number} number @param {() => unknown} order */
async function answer(number, order) {
  try {
    postStatus({ number, value: await order() });
  } catch (error) {
    postStatus({ number, error: error instanceof Error ? error.message : String(error) });
  }
}
