// Sends the hand's samples from a web worker (sample_worker.js), so that neither drawing nor a busy machine leaves gaps.
import { TRACKER_SESSION } from "./tracker_name.js";

/**
 * @typedef {{ms: number, within: number}} ClockOffset service clock minus page clock, and how far off it may be [ms]
 *
 * What the worker says of its TrackerSocket.
 * @typedef {{live: boolean, offset: ClockOffset | null, dropped: number, sequence: number}} SenderStatus
 *
 * @typedef {object} TrackerCallbacks
 * @property {(state: string, sentence: string) => void} onChange "live", "lost" (it connects again) or "refused" (it does not)
 * @property {(sentence: string) => void} onRejected the service did not take a message
 */

/** @type {SenderStatus} */
const INITIAL_STATUS = { live: false, offset: null, dropped: 0, sequence: 0 };

export class SampleSender {
  #status = INITIAL_STATUS;
  #worker = new Worker(new URL("./sample_worker.js", import.meta.url), { type: "module" });
  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  #requests = new Map(); // number of a request -> {resolve, reject}
  #requestCount = 0;

  /** @param {string} name @param {TrackerCallbacks} callbacks */
  constructor(name, { onChange, onRejected }) {
    this.onChange = onChange;
    this.onRejected = onRejected;
    this.#worker.onmessage = ({ data }) => this.#handleMessage(data);
    this.#worker.onerror = () =>
      this.#rejectAll(new Error("The page's own thread for samples does not run. Load the page again."));
    this.#worker.postMessage({ name, session: TRACKER_SESSION });
  }

  get live() {
    return this.#status.live;
  }

  get offset() {
    return this.#status.offset;
  }

  get dropped() {
    return this.#status.dropped;
  }

  get sequence() {
    return this.#status.sequence;
  }

  connect() {
    return this.#request({ order: "connect" });
  }

  /**
   * End the recording; resolves to its report.
   * @returns {Promise<RecordingReport>}
   */
  end({ discard = false } = {}) {
    return this.#request({ order: "end", discard });
  }

  /**
   * Where the hand is now: it is sampled there, at a fixed rate, until the next pose.
   * @param {Hand} hand
   */
  setPose(hand) {
    this.#worker.postMessage({ pose: hand });
  }

  /**
   * Send a sample that has its own time, as a headset's frame has; sampling at a fixed rate stops.
   * @param {HandSample} sample
   */
  send(sample) {
    this.#worker.postMessage({ sample });
  }

  close() {
    this.#worker.postMessage({ order: "close" });
    this.#rejectAll(new Error("The connection was closed."));
  }

  /** @param {object} message @returns {Promise<any>} */
  #request(message) {
    this.#requestCount += 1;
    const answer = new Promise((resolve, reject) => this.#requests.set(this.#requestCount, { resolve, reject }));
    this.#worker.postMessage({ ...message, number: this.#requestCount });
    return answer;
  }

  /** @param {import("./sample_worker.js").WorkerMessage} message */
  #handleMessage({ status, state, sentence, rejected, number, value, error }) {
    if (status) this.#status = status;
    if (state) this.onChange(state, sentence ?? "");
    if (rejected) this.onRejected(rejected);
    if (!number) return;
    const { resolve, reject } = this.#requests.get(number) ?? {};
    this.#requests.delete(number);
    if (error) reject?.(new Error(error));
    else resolve?.(value);
  }

  /** @param {Error} error */
  #rejectAll(error) {
    for (const { reject } of this.#requests.values()) reject(error);
    this.#requests.clear();
  }
}
