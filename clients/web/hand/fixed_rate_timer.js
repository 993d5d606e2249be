// Calls `callback(seconds)` at a fixed rate, independent of drawing: a timer whose drift is corrected.
export const SAMPLE_RATE = 60; // [Hz]

export class FixedRateTimer {
  #timer = 0;
  #due = 0;
  #before = 0;

  /**
   * @param {(seconds: number) => void} callback told the seconds since the call before
   * @param {{rate?: number, onLate?: (ms: number) => void}} options `onLate`: told how far apart two calls were, when that
   *   was more than two periods
   */
  constructor(callback, { rate = SAMPLE_RATE, onLate = () => {} } = {}) {
    this.callback = callback;
    this.onLate = onLate;
    this.period = 1000 / rate;
  }

  get running() {
    return this.#timer !== 0;
  }

  start() {
    if (this.running) return;
    this.#due = this.#before = performance.now();
    this.#schedule();
  }

  stop() {
    clearTimeout(this.#timer);
    this.#timer = 0;
  }

  #schedule() {
    this.#due += this.period;
    // After a stall the missed ones are not made up: a sample says where the hand is, not where it was.
    const now = performance.now();
    if (this.#due < now - this.period) this.#due = now;
    this.#timer = setTimeout(() => this.#tick(), Math.max(0, this.#due - now));
  }

  #tick() {
    const now = performance.now();
    this.#schedule(); // first, so that an error in `callback` does not end the sampling
    const elapsed = now - this.#before;
    this.#before = now;
    this.callback(elapsed / 1000);
    if (elapsed > 2 * this.period) this.onLate(elapsed);
  }
}
