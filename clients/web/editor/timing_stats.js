// How long the page takes to redraw a dragged curve, and the service to assess it.
const MAX_SAMPLES = 600;

export class TimingStats {
  /** @type {number[]} */
  #frames = []; // [ms] of work a frame: the curve, the buffers, the numbers beside the view
  /** @type {number[]} */
  #renderings = []; // [ms] that handing the scene to the graphics card takes; without one it is drawn meanwhile
  /** @type {number[]} */
  #intervals = []; // [ms] between two frames of one drag
  /** @type {number[]} */
  #answers = []; // [ms] from release to assessment
  #before = 0;

  /** @param {() => void} work @param {import("../view.js").View} view */
  measureFrame(work, view) {
    const began = performance.now();
    work();
    append(this.#frames, performance.now() - began);
    append(this.#renderings, view.renderTime);
    if (began - this.#before < 1000) append(this.#intervals, began - this.#before);
    this.#before = began;
  }

  /** @param {number} ms */
  addAnswer(ms) {
    append(this.#answers, ms);
  }

  get summary() {
    return {
      frames: this.#frames.length,
      work: percentiles(this.#frames),
      renderTime: percentiles(this.#renderings),
      interval: percentiles(this.#intervals),
      answer: percentiles(this.#answers),
    };
  }

  reset() {
    for (const list of [this.#frames, this.#renderings, this.#intervals, this.#answers]) list.length = 0;
  }
}

/** @param {number[]} list @param {number} value */
function append(list, value) {
  list.push(value);
  if (list.length > MAX_SAMPLES) list.shift();
}

/** @param {number[]} list */
function percentiles(list) {
  const sorted = [...list].sort((a, b) => a - b);
  /** @param {number} p */
  const share = (p) => sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))] ?? null;
  return { p50: share(0.5), p95: share(0.95), max: sorted.at(-1) ?? null };
}
