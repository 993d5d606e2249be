// Sends the hand's samples from a web worker (sample_worker.js), so that neither drawing nor a busy machine leaves gaps.
const INITIAL_STATUS = { live: false, offset: null, dropped: 0, sequence: 0 };

export class SampleSender {
  #status = INITIAL_STATUS; // of the worker's TrackerSocket
  #worker;
  #requests = new Map(); // number of a request -> {resolve, reject}
  #requestCount = 0;

  // Callbacks as of TrackerSocket.
  constructor(name, { onChange, onRejected }) {
    Object.assign(this, { onChange, onRejected });
    this.#worker = new Worker(new URL("./sample_worker.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#handleMessage(data);
    this.#worker.onerror = () =>
      this.#rejectAll(new Error("The page's own thread for samples does not run. Load the page again."));
    this.#worker.postMessage({ name });
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

  // End the recording; resolves to its report.
  end({ discard = false } = {}) {
    return this.#request({ order: "end", discard });
  }

  // Where the hand is now: it is sampled there, at a fixed rate, until the next pose.
  setPose(hand) {
    this.#worker.postMessage({ pose: hand });
  }

  // Send a sample that has its own time, as a headset's frame has; sampling at a fixed rate stops.
  send(sample) {
    this.#worker.postMessage({ sample });
  }

  close() {
    this.#worker.postMessage({ order: "close" });
    this.#rejectAll(new Error("The connection was closed."));
  }

  #request(message) {
    this.#requestCount += 1;
    const answer = new Promise((resolve, reject) => this.#requests.set(this.#requestCount, { resolve, reject }));
    this.#worker.postMessage({ ...message, number: this.#requestCount });
    return answer;
  }

  #handleMessage({ status, state, sentence, rejected, number, value, error }) {
    if (status) this.#status = status;
    if (state) this.onChange(state, sentence);
    if (rejected) this.onRejected(rejected);
    if (!number) return;
    const { resolve, reject } = this.#requests.get(number) ?? {};
    this.#requests.delete(number);
    if (error) reject?.(new Error(error));
    else resolve?.(value);
  }

  #rejectAll(error) {
    for (const { reject } of this.#requests.values()) reject(error);
    this.#requests.clear();
  }
}
