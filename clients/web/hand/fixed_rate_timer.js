// Calls `take(seconds)` at an even rate whatever is drawn: a timer whose drift is corrected, never a frame.
export const RATE = 60; // [Hz]

export class Sampler {
  #timer = 0;
  #due = 0;
  #before = 0;

  // `late(ms)` is told how far apart two calls were when that was more than it should be.
  constructor(take, { rate = RATE, late = () => {} } = {}) {
    Object.assign(this, { take, late });
    this.period = 1000 / rate;
  }

  get running() {
    return this.#timer !== 0;
  }

  start() {
    if (this.running) return;
    this.#due = this.#before = performance.now();
    this.#plan();
  }

  stop() {
    clearTimeout(this.#timer);
    this.#timer = 0;
  }

  #plan() {
    this.#due += this.period;
    // After a stall the missed ones are not made up: a sample says where the hand is, not where it was.
    const now = performance.now();
    if (this.#due < now - this.period) this.#due = now;
    this.#timer = setTimeout(() => this.#tick(), Math.max(0, this.#due - now));
  }

  #tick() {
    const now = performance.now();
    this.#plan(); // first, so that a fault in `take` does not end the sampling
    const apart = now - this.#before;
    this.#before = now;
    this.take(apart / 1000);
    if (apart > 2 * this.period) this.late(apart);
  }
}
