// Picking by the pointer in the 3-D view: hovering puts the focus on a demonstration or path, a click selects a path.
import { sampleCurve } from "./polyline.js";
import { latestPaths } from "./store.js";

const PICK_RADIUS = 9; // [px]
const POINTS_PER_PATH = 60;

export function enablePathPicking(view, store, sceneLayers) {
  const element = view.overlay.element;
  const curves = new WeakMap(); // learned path -> points
  const pointsOf = (path) => {
    if (!curves.has(path)) curves.set(path, sampleCurve(path.curve, POINTS_PER_PATH));
    return curves.get(path);
  };

  // The way under a pixel, a learned path before a demonstration, or null.
  const under = (x, y) => {
    const project = view.overlay.createProjector();
    const shown = {
      paths: () => latestPaths(store.state).map((path) => [path.id, pointsOf(path)]),
      demonstrations: () => sceneLayers.drawnTrajectories(),
    };
    for (const kind of Object.keys(shown).filter((layer) => view.isLayerVisible(layer))) {
      const found = shown[kind]().map(([id, points]) => ({
        id,
        distance: Math.min(...points.map((p) => distance(project(p), x, y))),
      }));
      const best = found.reduce((a, b) => (b.distance < a.distance ? b : a), { distance: PICK_RADIUS });
      if (best.id) return { kind, id: best.id };
    }
    return null;
  };

  let asked = false;
  element.addEventListener("pointermove", (event) => {
    if (event.buttons || asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const found = under(event.clientX, event.clientY);
      const { focus } = store.state;
      if (focus?.kind !== found?.kind || focus?.id !== found?.id) store.set({ focus: found });
    });
  });
  element.addEventListener("pointerleave", () => store.set({ focus: null }));
  let pressed = null;
  element.addEventListener("pointerdown", (event) => {
    pressed = view.viewer.controls.enabled ? [event.clientX, event.clientY] : null; // else something is being dragged
  });
  element.addEventListener("pointerup", (event) => {
    const still = pressed && distance(pressed, event.clientX, event.clientY) < 4;
    const found = still && under(event.clientX, event.clientY);
    if (found?.kind === "paths") store.set({ path: found.id });
  });
}

const distance = (seen, x, y) => (seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity);
