// The robot's axes as the camera sees them, small, in a corner of the view.
import { svgElement } from "./elements.js";

const [SIZE, LENGTH] = [64, 21]; // [px]
/** @type {[name: string, axis: number[]][]} in three's frame */
const AXES = [
  ["x", [1, 0, 0]],
  ["y", [0, 0, -1]],
  ["z", [0, 1, 0]],
];

/** @param {HTMLElement} stage around the view */
export function createCompass(stage) {
  const arms = AXES.map(([name, axis]) => {
    const [line, letter] = [svgElement("line", {}), svgElement("text", {}, name)];
    return { axis, line, letter };
  });
  const middle = `translate(${SIZE / 2} ${SIZE / 2})`;
  const marks = arms.flatMap(({ line, letter }) => [line, letter]);
  const drawing = svgElement("g", { transform: middle }, marks);
  stage.append(svgElement("svg", { class: "compass", viewBox: `0 0 ${SIZE} ${SIZE}`, "aria-hidden": "true" }, drawing));
  let shown = "";
  /** @param {THREE.Camera} camera */
  return (camera) => {
    const m = camera.matrixWorldInverse.elements;
    const key = [0, 1, 4, 5, 8, 9].map((k) => m[k].toFixed(3)).join();
    if (key === shown) return;
    shown = key;
    for (const { axis, line, letter } of arms) {
      const [x, y] = [0, 1].map((row) => LENGTH * axis.reduce((sum, part, k) => sum + part * m[4 * k + row], 0));
      line.setAttribute("x2", x.toFixed(1));
      line.setAttribute("y2", (-y).toFixed(1));
      letter.setAttribute("x", (1.4 * x).toFixed(1));
      letter.setAttribute("y", (-1.4 * y).toFixed(1));
    }
  };
}
