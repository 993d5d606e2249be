// The motion of a file over time: where the hand was and how fast; taking and putting are marked on it.
import { element, svgElement } from "../elements.js";
import { formatNumber } from "../texts.js";

const [WIDTH, HEIGHT] = [352, 132]; // of the drawing
const [TOP, BOTTOM] = [16, 16];
const SPEED_SHARE = 0.3; // of the height, below the positions
const AXES = ["x", "y", "z"];

/** @typedef {{grasp: number | null, release: number | null}} Marks [s] */

/** @typedef {"grasp" | "release"} Mark */

/** @type {Record<Mark, string>} */
export const MARK_NAMES = { grasp: "taken", release: "put" };

/**
 * @param {string} id of the file
 * @param {FileReport} report
 * @param {Marks} marks
 */
export function motionPlot(id, { times, positions, dwell_times }, marks) {
  const end = times.at(-1) ?? 0;
  const x = (/** @type {number} */ time) => (end > 0 ? (WIDTH * time) / end : 0);
  const border = HEIGHT - BOTTOM - SPEED_SHARE * (HEIGHT - TOP - BOTTOM);
  const speeds = speedsOf(times, positions);
  const label = `Position and speed over ${formatNumber(end, 1, "s")}; press to mark where the object is taken and put`;
  const plot = svgElement(
    "svg",
    { class: "motion-plot", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "data-plot": id, "aria-label": label, role: "group" },
    carriedBand(marks, x),
    AXES.map((_, axis) =>
      svgElement("path", { class: `way-${axis}`, d: line(times.map(x), scaled(spread(positions, axis), TOP, border)) }),
    ),
    svgElement("path", { class: "speed", d: line(times.map(x), scaled(speeds, border + 4, HEIGHT - BOTTOM)) }),
    dwell_times.map((time) =>
      svgElement("circle", { class: "dwell", cx: x(time).toFixed(1), cy: HEIGHT - BOTTOM, r: 4 }),
    ),
    /** @type {Mark[]} */ (["grasp", "release"]).map((mark) => markLine(id, mark, marks[mark], end, x)),
    svgElement("text", { x: 0, y: HEIGHT - 3 }, "0 s"),
    svgElement("text", { x: WIDTH, y: HEIGHT - 3, "text-anchor": "end" }, formatNumber(end, 1, "s")),
  );
  const keys = AXES.map((axis, k) => element("span", {}, element("span", { class: `swatch way-${k}` }), axis));
  const speed = element("span", {}, element("span", { class: "swatch speed" }), "speed");
  const dwell =
    dwell_times.length > 0 && element("span", {}, element("span", { class: "swatch dwell" }), "the hand dwells");
  return element("div", {}, plot, element("p", { class: "note legend" }, keys, speed, dwell));
}

/**
 * The time at a place of a plot [s], inside the motion.
 * @param {Element} plot
 * @param {number} clientX
 * @param {number[]} times
 */
export function timeAt(plot, clientX, times) {
  const { left, width } = plot.getBoundingClientRect();
  const share = Math.min(Math.max((clientX - left) / width, 0), 1);
  return Math.round(1000 * share * (times.at(-1) ?? 0)) / 1000;
}

/**
 * The mark that a press means: the missing one, else the nearer one.
 * @param {Marks} marks
 * @param {number} time [s]
 * @returns {Mark}
 */
export function nearestMark({ grasp, release }, time) {
  if (grasp === null) return "grasp";
  if (release === null) return "release";
  return Math.abs(time - grasp) <= Math.abs(time - release) ? "grasp" : "release";
}

/** @param {string} id @param {Mark} mark @param {number | null} time @param {number} end @param {(time: number) => number} x */
function markLine(id, mark, time, end, x) {
  if (time === null) return [];
  const at = x(time).toFixed(1);
  const right = x(time) > WIDTH - 40;
  const slider = {
    class: `mark ${mark}`,
    role: "slider",
    tabindex: "0",
    "aria-label": `When the object is ${MARK_NAMES[mark]}`,
    "aria-valuemin": 0,
    "aria-valuemax": end,
    "aria-valuenow": time,
    "aria-valuetext": formatNumber(time, 2, "s"),
    "data-mark": mark,
    "data-file": id,
    "data-key": `mark ${mark} ${id}`,
  };
  return svgElement(
    "g",
    slider,
    svgElement("line", { x1: at, x2: at, y1: 0, y2: HEIGHT - BOTTOM }),
    svgElement("text", { x: at, y: 11, dx: right ? -4 : 4, "text-anchor": right ? "end" : "start" }, MARK_NAMES[mark]),
  );
}

/** @param {Marks} marks @param {(time: number) => number} x */
function carriedBand({ grasp, release }, x) {
  if (grasp === null || release === null) return [];
  const width = Math.max(x(release) - x(grasp), 0).toFixed(1);
  return svgElement("rect", { class: "carried", x: x(grasp).toFixed(1), y: 0, width, height: HEIGHT - BOTTOM });
}

/** Speeds as shares of the highest one. @param {number[]} times @param {Point[]} positions */
function speedsOf(times, positions) {
  const speeds = times.map((_, k) => {
    const [before, after] = [Math.max(k - 1, 0), Math.min(k + 1, times.length - 1)];
    const seconds = times[after] - times[before];
    return seconds > 0 ? Math.hypot(...positions[after].map((c, i) => c - positions[before][i])) / seconds : 0;
  });
  const highest = Math.max(...speeds, 1e-9);
  return speeds.map((speed) => speed / highest);
}

/** One axis, with the spread of the widest one, so that all have one scale. @param {Point[]} positions @param {number} axis */
function spread(positions, axis) {
  const ranges = AXES.map((_, k) => [Math.min(...positions.map((p) => p[k])), Math.max(...positions.map((p) => p[k]))]);
  const widest = Math.max(...ranges.map(([low, high]) => high - low), 1e-9);
  const middle = (ranges[axis][0] + ranges[axis][1]) / 2;
  return positions.map((p) => 0.5 + (p[axis] - middle) / widest);
}

/** Shares of 0 to 1 as y of the drawing. @param {number[]} shares @param {number} top @param {number} bottom */
const scaled = (shares, top, bottom) => shares.map((share) => bottom - (bottom - top) * share);

/** @param {number[]} xs @param {number[]} ys */
const line = (xs, ys) => xs.map((x, k) => `${k ? "L" : "M"}${x.toFixed(1)},${ys[k].toFixed(1)}`).join("");
