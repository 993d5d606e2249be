// The page as a tracker: numbered, stamped samples over a WebSocket, and the offset of the page's clock.
import { resourcePath } from "../api.js";
import { ReconnectingSocket } from "../reconnecting_socket.js";
import { encodeHandSample } from "./hand_sample.js";

const MAX_BUFFERED_BYTES = 64 * 1024; // waiting in the socket, above which samples are dropped, but counted
const PING_INTERVAL = 1000; // [ms]
const FIRST_PINGS = 10; // sent ten times as often
const PINGS_KEPT = 30; // the fastest of them gives the offset
const REPORT_TIMEOUT = 30_000; // [ms] for the report at the end
const REFUSED_CODE = 1008; // close code of a service that does not take this tracker

// The page's clock: milliseconds since the Unix epoch that never run back.
export const clock = () => performance.timeOrigin + performance.now();

export class TrackerSocket {
  sequence = 0; // of the newest sample, sent or dropped
  dropped = 0;
  /** @type {{trip: number, offset: number}[]} */
  #pings = [];
  #pingTimer = 0;
  /** @type {{resolve: () => void, reject: (error: Error) => void} | null} */
  #connecting = null; // of connect()
  /** @type {{resolve: (report: RecordingReport) => void, reject: (error: Error) => void} | null} */
  #report = null; // of end()

  /**
   * @param {string} name
   * @param {string} session the page's secret
   * @param {import("./sample_sender.js").TrackerCallbacks} callbacks
   */
  constructor(name, session, { onChange, onRejected }) {
    this.onChange = onChange;
    this.onRejected = onRejected;
    this.socket = new ReconnectingSocket(`${resourcePath("trackers", name)}/samples?session=${session}`, {
      onOpen: () => this.#ping(),
      onMessage: (text) => this.#handleMessage(JSON.parse(text)),
      onState: (state, { reason = "" }) => this.#handleState(state, reason),
      isRefusal: (code) => code === REFUSED_CODE,
    });
  }

  get live() {
    return this.socket.isOpen;
  }

  /** Service clock minus page clock [ms], by the fastest of the last pings, and how far off it may be; or null. */
  get offset() {
    if (!this.#pings.length) return null;
    const best = this.#pings.reduce((a, b) => (a.trip <= b.trip ? a : b));
    return { ms: best.offset, within: best.trip / 2 };
  }

  /** Resolves when connected, rejects with the service's reason. */
  connect() {
    return /** @type {Promise<void>} */ (
      new Promise((resolve, reject) => {
        this.#connecting = { resolve, reject };
        this.socket.open();
      })
    );
  }

  /**
   * Number one sample and send it, unless the socket is full or closed: then it is dropped, and the report counts it as
   * lost.
   * @param {HandSample} sample
   */
  send(sample) {
    this.sequence += 1;
    if (this.live && this.socket.bufferedAmount <= MAX_BUFFERED_BYTES)
      this.socket.send(encodeHandSample({ ...sample, sequence: this.sequence }));
    else this.dropped += 1;
  }

  /**
   * End the recording with the handshake; resolves to its report.
   * @returns {Promise<RecordingReport>}
   */
  end({ discard = false } = {}) {
    return new Promise((resolve, reject) => {
      if (!this.live) {
        reject(new Error("There is no connection; the service ends the recording by itself."));
        return;
      }
      const timer = setTimeout(
        () => reject(new Error("The service has not sent the report of the recording.")),
        REPORT_TIMEOUT,
      );
      const finish = () => {
        clearTimeout(timer);
        this.#report = null;
      };
      this.#report = {
        resolve: (report) => {
          finish();
          resolve(report);
        },
        reject: (error) => {
          finish();
          reject(error);
        },
      };
      this.socket.send(JSON.stringify({ end: this.sequence, discard }));
    });
  }

  close() {
    clearTimeout(this.#pingTimer);
    this.socket.close();
  }

  /** @param {ConnectionState} state @param {string} reason */
  #handleState(state, reason) {
    if (state === "connecting") return;
    if (state === "live") {
      this.#connecting?.resolve();
      this.onChange("live", "");
      return;
    }
    clearTimeout(this.#pingTimer);
    this.#report?.reject(new Error("The connection broke off before the report came."));
    if (state === "refused") this.#connecting?.reject(new Error(reason));
    this.onChange(state, state === "refused" ? reason : "The connection to the service broke off; connecting again.");
  }

  #ping() {
    this.socket.send(JSON.stringify({ ping: clock() }));
    this.#pingTimer = setTimeout(
      () => this.#ping(),
      this.#pings.length < FIRST_PINGS ? PING_INTERVAL / 10 : PING_INTERVAL,
    );
  }

  /** @param {any} message */
  #handleMessage(message) {
    if ("pong" in message) {
      const now = clock();
      this.#pings.push({ trip: now - message.pong, offset: message.service_ns / 1e6 - (message.pong + now) / 2 });
      if (this.#pings.length > PINGS_KEPT) this.#pings.shift();
    } else if ("report" in message) {
      this.#report?.resolve(message.report);
    } else if ("refused" in message) {
      if (this.#report) this.#report.reject(new Error(message.refused));
      else this.onRejected(message.refused);
    }
  }
}
