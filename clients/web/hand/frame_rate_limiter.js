// Draws the view less often while a hand is sampled, where the machine cannot do both at once: samples come first.
const COST_FACTOR = 4; // where drawing makes samples late, frames are this many times its cost apart
const MAX_FRAME_INTERVAL = 10_000; // [ms]
const MIN_FRAME_INTERVAL = 20; // [ms] below which the frame rate is not limited
const INTERVAL_DECAY = 0.999; // per sample that came in time

export class FrameRateLimiter {
  /** @param {import("../view.js").View} view */
  constructor(view) {
    this.view = view;
  }

  /**
   * A sample was late: draw less often, by as much as drawing seems to cost.
   * @param {number} ms
   */
  onLate(ms) {
    this.view.setFrameInterval(Math.min(MAX_FRAME_INTERVAL, Math.max(this.view.frameInterval, COST_FACTOR * ms)));
  }

  /** A sample is taken: come slowly back to drawing as often as wanted. */
  onSample() {
    const { frameInterval } = this.view;
    if (!frameInterval) return;
    this.view.setFrameInterval(frameInterval < MIN_FRAME_INTERVAL ? 0 : INTERVAL_DECAY * frameInterval);
  }

  release() {
    this.view.setFrameInterval(0);
  }
}
