// A demonstration's course in small, all of a task on one scale, so that they can be compared at a glance.
import { drawing } from "./elements.js";

const [WIDE, HIGH, EDGE] = [44, 26, 2];

// How courses are laid flat: the two axes along which they reach farthest, one scale for all.
export function flattening(courses) {
  const points = courses.flat();
  const low = [0, 1, 2].map((axis) => points.reduce((least, p) => Math.min(least, p[axis]), Infinity));
  const size = [0, 1, 2].map((axis) => points.reduce((most, p) => Math.max(most, p[axis]), -Infinity) - low[axis]);
  const [across, up] = [0, 1, 2].sort((a, b) => size[b] - size[a]);
  const scale = Math.min((WIDE - 2 * EDGE) / (size[across] || 1), (HIGH - 2 * EDGE) / (size[up] || 1));
  return { across, up, low, size, scale };
}

export function thumbnail(points, { across, up, low, size, scale }, looks) {
  const [left, bottom] = [(WIDE - size[across] * scale) / 2, (HIGH - size[up] * scale) / 2];
  const flat = points.map((p) => [left + (p[across] - low[across]) * scale, HIGH - bottom - (p[up] - low[up]) * scale]);
  const path = flat.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`).join("");
  const [x, y] = flat[0];
  return drawing(
    "svg",
    { class: `thumbnail ${looks}`, width: WIDE, height: HIGH, viewBox: `0 0 ${WIDE} ${HIGH}`, "aria-hidden": "true" },
    drawing("path", { d: path }),
    drawing("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 1.8 }),
  );
}
