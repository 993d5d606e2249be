// A WebSocket to the service that connects again by itself: after each failure it waits twice as long as before, within
// limits, and not all pages the same time, so that a restarted service is not asked by all of them at once.
import { socketUrl } from "./api.js";

const MIN_DELAY = 250; // [ms] before the first new attempt
const MAX_DELAY = 2000; // [ms]

export class ReconnectingSocket {
  #socket = null;
  #delay = MIN_DELAY;
  #timer = 0;

  // `path` below /api/v1. `onMessage(data)`: text, or an ArrayBuffer; `onOpen()`: data may be sent.
  // `onState(state, {delay, reason})`: "connecting"; "live" with the first message, which says that the service has accepted
  // this client; "lost", and it connects again in `delay` s; "refused" for `reason`, and it does not, which is where
  // `isRefusal(code)` holds for the code of the close.
  constructor(path, { onMessage, onOpen = () => {}, onState = () => {}, isRefusal = () => false }) {
    Object.assign(this, { path, onMessage, onOpen, onState, isRefusal });
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

  // Send text or bytes; nothing while there is no connection.
  send(data) {
    if (this.isOpen) this.#socket.send(data);
  }

  // Close for good, without a further call; open() begins anew.
  close() {
    const socket = this.#socket;
    this.#socket = null;
    clearTimeout(this.#timer);
    socket?.close();
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
