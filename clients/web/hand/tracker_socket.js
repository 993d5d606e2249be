// The page as a tracker: numbered, stamped samples over a WebSocket, and the offset of the page's clock.
import { socketAddress } from "../api.js";
import { encode } from "./hand_sample.js";

const FULL = 64 * 1024; // bytes waiting in the socket, over which samples are left out, but counted
const PING = 1000; // [ms]
const PINGS = 30; // newest ones, of which the fastest tells the offset
const PATIENCE = 30_000; // [ms] for the account at the end
const SHORTEST = 250; // [ms] pause before connecting again
const LONGEST = 2000;

// The page's clock: milliseconds since the Unix epoch that never run back.
export const clock = () => performance.timeOrigin + performance.now();

export class HandLink {
  sequence = 0; // of the newest sample, sent or left out
  leftOut = 0;
  #socket = null;
  #pings = [];
  #report = null;
  #pause = SHORTEST;
  #closed = false;

  // `changed(state, sentence)`: "live", "lost" (it connects again) or "refused" (it does not).
  constructor(name, { changed, refused }) {
    Object.assign(this, { name, changed, refused });
  }

  get live() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  // Service clock minus page clock [ms], by the fastest of the last pings, and how far off it may be; or null.
  get offset() {
    if (!this.#pings.length) return null;
    const best = this.#pings.reduce((a, b) => (a.trip <= b.trip ? a : b));
    return { ms: best.offset, within: best.trip / 2 };
  }

  // Resolves when connected, rejects with the service's reason.
  connect() {
    return new Promise((resolve, reject) => {
      const socket = new WebSocket(socketAddress(`trackers/${encodeURIComponent(this.name)}/samples`));
      this.#socket = socket;
      socket.onopen = () => {
        this.#ping();
      };
      socket.onmessage = ({ data }) => {
        // The first answer says that the gate let us in.
        if (!socket.admitted) {
          socket.admitted = true;
          this.#pause = SHORTEST;
          this.changed("live", "");
          resolve();
        }
        this.#hear(JSON.parse(data));
      };
      socket.onclose = ({ code, reason }) => {
        clearTimeout(this.timer);
        this.#report?.reject(new Error("The connection broke off before the account came."));
        this.#report = null;
        if (this.#closed) return;
        if (code === 1008) {
          this.changed("refused", reason);
          reject(new Error(reason));
          return;
        }
        this.changed("lost", "The connection to the service broke off; connecting again.");
        this.again = setTimeout(() => this.connect().then(resolve, reject), this.#pause);
        this.#pause = Math.min(LONGEST, 2 * this.#pause);
      };
    });
  }

  // Count one sample and send it, unless the socket is full or away: it is then missing, and the account says so.
  send(sample) {
    this.sequence += 1;
    if (!this.live || this.#socket.bufferedAmount > FULL) {
      this.leftOut += 1;
      return;
    }
    this.#socket.send(encode({ ...sample, sequence: this.sequence }));
  }

  // End the recording with the handshake; resolves to its account.
  end({ discard = false } = {}) {
    return new Promise((resolve, reject) => {
      if (!this.live) {
        reject(new Error("There is no connection; the service ends the recording by itself."));
        return;
      }
      const timer = setTimeout(() => reject(new Error("The service has not sent the account of the recording.")), PATIENCE);
      const over = (finish) => (value) => {
        clearTimeout(timer);
        this.#report = null;
        finish(value);
      };
      this.#report = { resolve: over(resolve), reject: over(reject) };
      this.#socket.send(JSON.stringify({ end: this.sequence, discard }));
    });
  }

  close() {
    this.#closed = true;
    clearTimeout(this.timer);
    clearTimeout(this.again);
    this.#socket?.close();
  }

  #ping() {
    if (!this.live) return;
    this.#socket.send(JSON.stringify({ ping: clock() }));
    this.timer = setTimeout(() => this.#ping(), this.#pings.length < 10 ? PING / 10 : PING);
  }

  #hear(answer) {
    if ("pong" in answer) {
      const now = clock();
      this.#pings.push({ trip: now - answer.pong, offset: answer.service_ns / 1e6 - (answer.pong + now) / 2 });
      if (this.#pings.length > PINGS) this.#pings.shift();
    } else if ("report" in answer) {
      this.#report?.resolve(answer.report);
    } else if ("refused" in answer) {
      if (this.#report) this.#report.reject(new Error(answer.refused));
      else this.refused(answer.refused);
    }
  }
}
