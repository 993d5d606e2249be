// The pointer in the 3-D view: on a way it puts the focus there, a click on a learned path chooses it.
import { sampled } from "./polyline.js";
import { pathsOf } from "./store.js";

const NEAR = 9; // [px] the pointer is on a way
const POINTS = 60; // of a learned path that are tried

export function point(view, store, gallery) {
  const element = view.easel.element;
  const curves = new WeakMap(); // learned path -> points
  const pointsOf = (path) => {
    if (!curves.has(path)) curves.set(path, sampled(path.curve, POINTS));
    return curves.get(path);
  };

  // The way under a pixel, a learned path before a demonstration, or null.
  const under = (x, y) => {
    const project = view.easel.projector();
    const shown = {
      paths: () => pathsOf(store.state).map((path) => [path.id, pointsOf(path)]),
      demonstrations: () => gallery.drawn(),
    };
    for (const kind of Object.keys(shown).filter((layer) => view.isShown(layer))) {
      const found = shown[kind]().map(([id, points]) => ({ id, away: Math.min(...points.map((p) => away(project(p), x, y))) }));
      const best = found.reduce((a, b) => (b.away < a.away ? b : a), { away: NEAR });
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
    pressed = view.viewer.controls.enabled ? [event.clientX, event.clientY] : null; // else somebody has grabbed something
  });
  element.addEventListener("pointerup", (event) => {
    const still = pressed && away(pressed, event.clientX, event.clientY) < 4;
    const found = still && under(event.clientX, event.clientY);
    if (found?.kind === "paths") store.set({ path: found.id });
  });
}

const away = (seen, x, y) => (seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity);
