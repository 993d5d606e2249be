// The operator's page: puts the 3-D view and the panel together.
import { Panel } from "./panel.js";
import { View } from "./view.js";

const root = document.documentElement;
const connection = document.getElementById("connection");

const view = new View(document.getElementById("view"), {
  connected(state, seconds) {
    root.dataset.connection = state;
    connection.textContent = {
      live: "Connected",
      connecting: "Connecting to the service …",
      lost: `No connection to the service; trying again in ${Math.max(1, Math.round(seconds))} s`,
    }[state];
  },
  ready() {
    root.dataset.scene = "ready";
  },
});

for (const box of document.querySelectorAll("[data-layer]")) {
  box.addEventListener("change", () => view.show(box.dataset.layer, box.checked));
}
document.getElementById("home").addEventListener("click", () => view.home());

new Panel(document).start();
view.connect();

// What the browser tests, and the curious, may ask: paths drawn, where they are, how often the view was drawn.
globalThis.teachpath = {
  paths: () => view.paths(),
  place: (path) => view.place(path),
  get draws() {
    return view.draws;
  },
};
