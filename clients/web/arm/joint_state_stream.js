// Joint states over the service's WebSocket, for as long as somebody looks.
import { socketAddress } from "../api.js";

const PAUSE = 1000; // [ms] before connecting again

export class JointStream {
  #socket = null;

  // `hear(frame)` is called some 25 times a second while the arm moves, once a second while it rests.
  constructor(hear) {
    this.hear = hear;
  }

  start() {
    if (this.#socket) return;
    const socket = new WebSocket(socketAddress("joints"));
    this.#socket = socket;
    socket.onmessage = ({ data }) => this.hear(JSON.parse(data));
    socket.onclose = () => {
      if (this.#socket !== socket) return;
      this.#socket = null;
      this.again = setTimeout(() => this.start(), PAUSE);
    };
  }

  stop() {
    const socket = this.#socket;
    this.#socket = null;
    clearTimeout(this.again);
    socket?.close();
  }
}
