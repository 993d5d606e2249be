// A WebSocket to the service that connects again by itself: after each failure it waits twice as long as before, within
// limits, and not all pages the same time, so that a restarted service is not asked by all of them at once.
import { socketUrl } from "./api.js";

const MIN_DELAY = 250; // [ms] before the first new attempt
const MAX_DELAY = 2000; // [ms]

/**
 * @typedef {object} SocketOptions
 * @property {(data: any) => void} onMessage text, or an ArrayBuffer
 * @property {() => void} [onOpen] data may be sent
 * @property {(state: ConnectionState, details: ConnectionDetails) => void} [onState] "connecting"; "live" with the first
 *   message, which says that the service has accepted this client; "lost", and it connects again in `delay` s; "refused" for
 *   `reason`, and it does not
 * @property {(code: number) => boolean} [isRefusal] whether the code of a close means that
 */

export class ReconnectingSocket {
  /** @type {WebSocket | null} */
  #socket = null;
  #delay = MIN_DELAY;
  #timer = 0;

  /** @param {string} path below /api/v1 @param {SocketOptions} options */
  constructor(path, { onMessage, onOpen = () => {}, onState = () => {}, isRefusal = () => false }) {
    this.path = path;
    this.onMessage = onMessage;
    this.onOpen = onOpen;
    this.onState = onState;
    this.isRefusal = isRefusal;
  }

  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  // Bytes that wait to be sent.
  get bufferedAmount() {
    return this.#socket?.bufferedAmount ?? 0;
  }

  // Connect, unless that has been done.
  open() {
    if (!this.#socket) this.#connect();
  }

  /**
   * Send text or bytes; nothing while there is no connection.
   * @param {string | Uint8Array<ArrayBuffer>} data
   */
  send(data) {
    if (this.isOpen) this.#socket?.send(data);
  }

  // Close for good, without a further call; open() begins anew.
  close() {
    const socket = this.#socket;
    this.#socket = null;
    clearTimeout(this.#timer);
    if (socket?.readyState === WebSocket.CONNECTING) {
      socket.onopen = () => socket.close(); // closed before it is open, the browser would warn of a connection that failed
    } else {
      socket?.close();
    }
  }

  #connect() {
    const socket = new WebSocket(socketUrl(this.path));
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    let isLive = false;
    socket.onopen = () => this.#socket === socket && this.onOpen();
    socket.onmessage = ({ data }) => {
      if (this.#socket !== socket) return;
      if (!isLive) {
        isLive = true;
        this.#delay = MIN_DELAY;
        this.onState("live", {});
      }
      this.onMessage(data);
    };
    socket.onclose = ({ code, reason }) => this.#socket === socket && this.#onClose(code, reason);
    this.onState("connecting", {});
  }

  /** @param {number} code @param {string} reason */
  #onClose(code, reason) {
    if (this.isRefusal(code)) {
      this.#socket = null;
      this.onState("refused", { reason });
      return;
    }
    const delay = this.#delay * (0.75 + Math.random() / 2);
    this.#delay = Math.min(MAX_DELAY, 2 * this.#delay);
    this.#timer = setTimeout(() => this.#connect(), delay);
    this.onState("lost", { delay: delay / 1000 });
  }
}
