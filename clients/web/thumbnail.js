// A demonstration's trajectory in small; all of a task have one scale, so that they can be compared at a glance.
import { svgElement } from "./elements.js";

const [WIDTH, HEIGHT, PADDING] = [44, 26, 2];

/**
 * How trajectories are projected: on the two axes along which they reach farthest, with one scale for all.
 * @param {Point[][]} trajectories
 */
export function fitProjection(trajectories) {
  const points = trajectories.flat();
  const low = [0, 1, 2].map((axis) => points.reduce((least, p) => Math.min(least, p[axis]), Infinity));
  const size = [0, 1, 2].map((axis) => points.reduce((most, p) => Math.max(most, p[axis]), -Infinity) - low[axis]);
  const [across, up] = [0, 1, 2].sort((a, b) => size[b] - size[a]);
  const scale = Math.min((WIDTH - 2 * PADDING) / (size[across] || 1), (HEIGHT - 2 * PADDING) / (size[up] || 1));
  return { across, up, low, size, scale };
}

/** @param {Point[]} points @param {ReturnType<typeof fitProjection>} projection @param {string} className */
export function thumbnail(points, { across, up, low, size, scale }, className) {
  const [left, bottom] = [(WIDTH - size[across] * scale) / 2, (HEIGHT - size[up] * scale) / 2];
  const flat = points.map((p) => [
    left + (p[across] - low[across]) * scale,
    HEIGHT - bottom - (p[up] - low[up]) * scale,
  ]);
  const path = flat.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`).join("");
  const [x, y] = flat[0];
  return svgElement(
    "svg",
    {
      class: `thumbnail ${className}`,
      width: WIDTH,
      height: HEIGHT,
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      "aria-hidden": "true",
    },
    svgElement("path", { d: path }),
    svgElement("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 1.8 }),
  );
}
