// The controls of the view: which layers are shown, from where one looks, by buttons and by the keyboard.
import { VIEWPOINTS } from "./camera.js";
import { closestData, element } from "./elements.js";
import { GRID_CELL } from "./environment.js";
import { sampleCurve } from "./polyline.js";
import { selectedPath } from "./store.js";
import { formatLength } from "./texts.js";

const TURN = Math.PI / 24; // [rad] by an arrow key
const ZOOM = 1.15;
/** What arrow keys do, where nobody else uses them. @type {Record<string, {around?: number, over?: number}>} */
const TURNS = {
  ArrowLeft: { around: -TURN },
  ArrowRight: { around: TURN },
  ArrowUp: { over: TURN },
  ArrowDown: { over: -TURN },
};
/** @type {Record<string, number>} */
const ZOOMS = { "+": ZOOM, "=": ZOOM, "-": 1 / ZOOM };
/** @type {Record<string, string>} */
const KEY_VIEWPOINTS = { 0: "home", 1: "front", 2: "side", 3: "top", f: "way" };

/** @param {import("./view.js").View} view @param {import("./store.js").Store} store */
export function connectViewControls(view, store) {
  for (const box of document.querySelectorAll("input[data-layer]")) {
    const { dataset } = /** @type {HTMLInputElement} */ (box);
    box.addEventListener("change", () => {
      view.setLayerVisible(dataset.layer ?? "", /** @type {HTMLInputElement} */ (box).checked);
    });
  }
  document.querySelector(".meanings")?.append(element("span", {}, `grid ${formatLength(GRID_CELL)}`));
  /** @param {string} from a viewpoint, or "way": the chosen one as near as it goes */
  const look = (from) => {
    const path = selectedPath(store.state);
    if (from !== "way") view.lookFrom(VIEWPOINTS[from]);
    else if (path) view.frame(sampleCurve(path.curve));
  };
  document.querySelector(".tools")?.addEventListener("click", (event) => {
    const from = closestData(event).look;
    if (from === "home") view.resetCamera();
    else if (from) look(from);
  });
  view.overlay.element.addEventListener("keydown", (event) => {
    const { key, altKey, ctrlKey, metaKey } = event;
    if (event.defaultPrevented || altKey || ctrlKey || metaKey) return;
    const turn = view.overlay.areKeysTaken ? undefined : TURNS[key];
    const from = KEY_VIEWPOINTS[key.toLowerCase()];
    if (turn) view.move(turn);
    else if (ZOOMS[key]) view.move({ nearer: ZOOMS[key] });
    else if (from === "home") view.resetCamera();
    else if (from) look(from);
    else return;
    event.preventDefault();
  });
}
