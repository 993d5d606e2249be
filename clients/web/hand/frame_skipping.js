// Decides whether a headset's frame is drawn. Samples come with the frames, and a frame waits until the one before is drawn:
// where drawing is slow, samples come first, and drawing leaves no gap in a demonstration.
const LATE_FRAME = 40; // [ms] between two frames; more than any headset has by itself
const MAX_SAMPLE_GAP = 90; // [ms] without a sample; where drawing costs more, nothing is drawn during a demonstration
const MAX_FRAME_INTERVAL = 10_000; // [ms] between two drawn frames where each costs more than that
const COST_FACTOR = 4; // where drawing makes frames late, drawn frames are this many times its cost apart
const COST_DECAY = 0.995; // per frame that came in time

export class FrameSkipper {
  /** @type {number | null} */
  #before = null; // [ms] of the frame before
  #drawn = -Infinity; // [ms] of the newest drawn frame
  cost = 0; // [ms] that drawing seems to cost

  /**
   * @param {number} time of the frame [ms]
   * @param {boolean} busy a demonstration is under way or may begin at any moment
   */
  shouldRender(time, busy) {
    const elapsed = time - (this.#before ?? time);
    this.#before = time;
    if (elapsed > LATE_FRAME) this.cost = Math.max(elapsed, this.cost);
    else if (!busy) this.cost *= COST_DECAY; // a cost before a demonstration stays until its end
    const costly = this.cost > MAX_SAMPLE_GAP;
    const interval = costly ? MAX_FRAME_INTERVAL : this.cost > LATE_FRAME ? COST_FACTOR * this.cost : 0;
    if ((costly && busy) || time - this.#drawn < interval) return false;
    this.#drawn = time;
    return true;
  }
}
