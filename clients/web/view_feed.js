// The view's WebSocket. Server to page: batches of drawing commands, the first of a connection being the whole scene. Page
// to server: the number of batches drawn, as text, from the next animation frame.
import { ReconnectingSocket } from "./reconnecting_socket.js";

/**
 * Draw what the service sends.
 * @param {import("./view.js").View} view
 * @param {(state: ConnectionState, details: ConnectionDetails) => void} onConnection
 */
export function feedView(view, onConnection) {
  let undrawn = 0; // batches that have come since the last frame
  const acknowledge = () => {
    if (undrawn) socket.send(String(undrawn));
    undrawn = 0;
  };
  const socket = new ReconnectingSocket("view", {
    onMessage: (batch) => {
      if (undrawn++ === 0) requestAnimationFrame(acknowledge);
      view.draw(batch);
    },
    onState: (state, details) => {
      if (state === "live") {
        undrawn = 0;
        view.clearServiceObjects(); // the first batch is the whole scene
      }
      onConnection(state, details);
    },
  });
  socket.open();
}
