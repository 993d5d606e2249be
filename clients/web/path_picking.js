// Picking by the pointer in the 3-D view: hovering puts the focus on a demonstration or path, a click selects a path.
import { sampleCurve } from "./polyline.js";
import { latestPaths } from "./store.js";

const PICK_RADIUS = 9; // [px]
const CLICK_TOLERANCE = 4; // [px]
const POINTS_PER_PATH = 60;

/**
 * @param {import("./view.js").View} view
 * @param {import("./store.js").Store} store
 * @param {import("./scene_layers.js").SceneLayers} sceneLayers
 */
export function enablePathPicking(view, store, sceneLayers) {
  const { element } = view.overlay;
  const pick = picker(view, store, sceneLayers);
  let asked = false;
  element.addEventListener("pointermove", (event) => {
    if (event.buttons || asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const found = pick([event.clientX, event.clientY]);
      const { focus } = store.state;
      if (focus?.kind !== found?.kind || focus?.id !== found?.id) store.set({ focus: found });
    });
  });
  element.addEventListener("pointerleave", () => store.set({ focus: null }));
  /** @type {number[] | null} */
  let pressed = null;
  element.addEventListener("pointerdown", (event) => {
    pressed = view.viewer.controls.enabled ? [event.clientX, event.clientY] : null; // else something is being dragged
  });
  element.addEventListener("pointerup", (event) => {
    const pixel = [event.clientX, event.clientY];
    const found = distance(pressed, pixel) < CLICK_TOLERANCE ? pick(pixel) : null;
    if (found?.kind === "paths") store.set({ path: found.id });
  });
}

/**
 * Returns what finds the way under a pixel: a learned path before a demonstration, or null.
 * @param {import("./view.js").View} view
 * @param {import("./store.js").Store} store
 * @param {import("./scene_layers.js").SceneLayers} sceneLayers
 */
function picker(view, store, sceneLayers) {
  /** @type {WeakMap<LearnedPath, Point[]>} */
  const sampled = new WeakMap();
  /** @param {LearnedPath} path */
  const pointsOf = (path) => {
    const points = sampled.get(path) ?? sampleCurve(path.curve, POINTS_PER_PATH);
    sampled.set(path, points);
    return points;
  };
  /** @returns {[kind: string, lines: [id: string, points: Point[]][]][]} */
  const candidates = () => [
    ["paths", latestPaths(store.state).map((path) => [path.id, pointsOf(path)])],
    ["demonstrations", sceneLayers.drawnTrajectories()],
  ];
  /** @param {number[]} pixel @returns {Focus | null} */
  return (pixel) => {
    const project = view.overlay.createProjector();
    for (const [kind, lines] of candidates().filter(([layer]) => view.isLayerVisible(layer))) {
      const best = { id: "", off: PICK_RADIUS };
      for (const [id, points] of lines) {
        const off = Math.min(...points.map((point) => distance(project(point), pixel)));
        if (off < best.off) Object.assign(best, { id, off });
      }
      if (best.id) return { kind, id: best.id };
    }
    return null;
  };
}

/** @param {number[] | null} a @param {number[]} b */
const distance = (a, b) => (a ? Math.hypot(a[0] - b[0], a[1] - b[1]) : Infinity);
