// Takes the hand's samples to the service from a thread of its own (sample_worker.js): a page that draws, or waits for its turn on a
// busy machine, tears no gap into them.
const STANDING = { live: false, offset: null, leftOut: 0, sequence: 0 };

export class Courier {
  #standing = STANDING; // as HandLink says it
  #worker;
  #answers = new Map(); // number of a question -> {resolve, reject}
  #asked = 0;

  // As of HandLink.
  constructor(name, { changed, refused }) {
    Object.assign(this, { changed, refused });
    this.#worker = new Worker(new URL("./sample_worker.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear(data);
    this.#worker.onerror = () => this.#break(new Error("The page's own thread for samples does not run. Load the page again."));
    this.#worker.postMessage({ name });
  }

  get live() {
    return this.#standing.live;
  }

  get offset() {
    return this.#standing.offset;
  }

  get leftOut() {
    return this.#standing.leftOut;
  }

  get sequence() {
    return this.#standing.sequence;
  }

  connect() {
    return this.#ask({ order: "connect" });
  }

  // The account of the recording.
  end({ discard = false } = {}) {
    return this.#ask({ order: "end", discard });
  }

  // Where the hand is now: it is sampled there, at an even rate, until it is said to be elsewhere.
  pose(hand) {
    this.#worker.postMessage({ pose: hand });
  }

  // A sample that has its own time, as a headset's frame has; nothing else is sampled meanwhile.
  send(sample) {
    this.#worker.postMessage({ sample });
  }

  close() {
    this.#worker.postMessage({ order: "close" });
    this.#break(new Error("The connection was closed."));
  }

  #ask(question) {
    this.#asked += 1;
    const answer = new Promise((resolve, reject) => this.#answers.set(this.#asked, { resolve, reject }));
    this.#worker.postMessage({ ...question, number: this.#asked });
    return answer;
  }

  #hear({ standing, state, sentence, refused, number, value, error }) {
    if (standing) this.#standing = standing;
    if (state) this.changed(state, sentence);
    if (refused) this.refused(refused);
    if (!number) return;
    const { resolve, reject } = this.#answers.get(number) ?? {};
    this.#answers.delete(number);
    if (error) reject?.(new Error(error));
    else resolve?.(value);
  }

  #break(error) {
    for (const { reject } of this.#answers.values()) reject(error);
    this.#answers.clear();
  }
}
