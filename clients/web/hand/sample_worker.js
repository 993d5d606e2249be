// The thread of sample_sender.js: samples the hand where the page last said it to be, evenly whatever the page is doing, and
// sends it.
import { HandLink, clock } from "./tracker_socket.js";
import { Sampler } from "./fixed_rate_timer.js";

const STALE = 2000; // [ms] without news of the page, after which its hand counts as lost: until then it stands still
const STRIDE = 0.036; // [m] between two samples: more would be taken for a jump of the tracker
const TELL = 15; // samples between two accounts to the page

let link = null;
let hand = null; // {position, orientation, tracked, grasp, clutch} as the page last said it
let heard = 0; // [ms] when it said so
let newest = null; // of which the last sample was

const sampler = new Sampler(() => {
  newest = follow(newest ?? hand, hand);
  send({ ...newest, tracked: hand.tracked && performance.now() - heard < STALE, ms: clock() });
});

// One stride of the hand after where the page is with it; what it holds, it holds until it is there, but for the clutch.
function follow(from, to) {
  const way = to.position.map((value, i) => value - from.position[i]);
  const far = Math.hypot(...way);
  if (far <= STRIDE) return to;
  return { ...from, clutch: from.clutch && to.clutch, position: from.position.map((value, i) => value + (way[i] * STRIDE) / far) };
}

onmessage = async ({ data }) => {
  const { name, pose, sample, order, number } = data;
  if (name) link = new HandLink(name, { changed: (state, sentence) => tell({ state, sentence }), refused: (refused) => tell({ refused }) });
  if (pose) {
    [hand, heard] = [pose, performance.now()];
    sampler.start();
  }
  if (sample) {
    sampler.stop();
    newest = null;
    send(sample);
  }
  if (order === "close") {
    link.close();
    close();
  } else if (order) await answer(number, order === "connect" ? () => link.connect() : () => end(data));
};

// Nothing more is sampled: the account's last number is the last that was sent.
function end({ discard }) {
  sampler.stop();
  return link.end({ discard });
}

function send(sample) {
  link.send(sample);
  if (link.sequence % TELL === 0) tell({});
}

function tell(news) {
  const { live, offset, leftOut, sequence } = link;
  postMessage({ ...news, standing: { live, offset, leftOut, sequence } });
}

async function answer(number, order) {
  try {
    tell({ number, value: await order() });
  } catch (error) {
    tell({ number, error: error.message });
  }
}
