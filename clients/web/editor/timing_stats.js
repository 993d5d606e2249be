// How long the page takes to redraw a dragged curve, and the service to look at it: measured where it happens.
const KEPT = 600;

export class Stopwatch {
  #frames = []; // [ms] of work a frame: the curve, the buffers, the numbers beside the view
  #renderings = []; // [ms] that handing the scene to the graphics card takes; without one it is drawn meanwhile
  #intervals = []; // [ms] between two frames of one drag
  #answers = []; // [ms] from release to verdict
  #before = 0;

  time(work, view) {
    const began = performance.now();
    work();
    add(this.#frames, performance.now() - began);
    add(this.#renderings, view.rendering);
    if (began - this.#before < 1000) add(this.#intervals, began - this.#before);
    this.#before = began;
  }

  answered(ms) {
    add(this.#answers, ms);
  }

  get figures() {
    return { frames: this.#frames.length, work: shares(this.#frames), rendering: shares(this.#renderings), interval: shares(this.#intervals), answer: shares(this.#answers) };
  }

  reset() {
    for (const list of [this.#frames, this.#renderings, this.#intervals, this.#answers]) list.length = 0;
  }
}

function add(list, value) {
  list.push(value);
  if (list.length > KEPT) list.shift();
}

function shares(list) {
  const sorted = [...list].sort((a, b) => a - b);
  const share = (p) => sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))] ?? null;
  return { p50: share(0.5), p95: share(0.95), max: sorted.at(-1) ?? null };
}
