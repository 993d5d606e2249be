// Plots of the joints against time: positions, velocities against their limits, tracking error and lateness.
import { element } from "../elements.js";
import { LinePlot } from "../line_plot.js";
import { patchChildren } from "../patch_children.js";

const HEIGHT = 132; // [px] of one plot
const DEGREES_PER_RADIAN = 180 / Math.PI;

/**
 * @typedef {"positions" | "speeds" | "error" | "lateness"} PlotName
 * @typedef {{time: number} & Record<PlotName, (number | null)[]>} PlotRow what all plots show at one time [s]
 * @typedef {import("../line_plot.js").PlotOptions["yRange"]} Range
 * @typedef {object} JointSample
 * @property {number} time [s]
 * @property {number[]} position [rad]
 * @property {number[]} speed [rad/s]
 * @property {number | null} error [rad]
 * @property {number | null} lateness [s]
 */

/** @type {{name: PlotName, title: string, series?: string[], yRange: Range, limits?: number[]}[]} without `series`: the joints */
const PLOTS = [
  { name: "positions", title: "Joint positions [°]", yRange: padded },
  {
    name: "speeds",
    title: "Joint speeds, share of the limit [%]",
    yRange: [-105, 105],
    limits: [-100, 100],
  },
  {
    name: "error",
    title: "Tracking error, largest over the joints [mrad]",
    series: ["tracking error"],
    yRange: fromZero(1),
  },
  { name: "lateness", title: "Lateness of the setpoints [µs]", series: ["lateness"], yRange: fromZero(100) },
];

/**
 * @param {Robot} arm its speed limits
 * @param {JointSample} sample
 * @returns {PlotRow}
 */
export function plotRow(arm, { time, position, speed, error, lateness }) {
  return {
    time,
    positions: position.map((value) => value * DEGREES_PER_RADIAN),
    speeds: speed.map((value, i) => (100 * value) / arm.speed[i]),
    error: [error === null ? null : 1000 * error],
    lateness: [lateness === null ? null : 1e6 * lateness],
  };
}

export class JointPlots {
  /** @type {PlotRow[]} */
  #rows = [];
  #values = element("dl", { class: "values" });
  #frame = 0;
  /** @type {number | null} */
  #cursorTime = null; // [s]

  /**
   * @param {HTMLElement} place
   * @param {Robot} arm whose joints they are, by name
   * @param {{window?: number}} options `window` [s] of the newest rows is shown; 0: all of them
   */
  constructor(place, arm, { window = 0 } = {}) {
    this.window = window;
    this.joints = arm.joints.map(({ name }) => name);
    this.element = element("div", { class: "plots" });
    place.append(this.element);
    this.plots = PLOTS.map((plot) => this.#createPlot(plot));
    this.element.append(this.#values);
    new ResizeObserver(() => this.#scheduleDraw()).observe(this.element); // it may have been hidden
  }

  /** @param {PlotRow} row */
  append(row) {
    if (row.time <= (this.#rows.at(-1)?.time ?? -Infinity)) this.#rows = []; // another execution
    this.#rows.push(row);
    if (this.window) {
      const first = this.#rows.findIndex((one) => one.time >= row.time - this.window);
      if (first > 50) this.#rows.splice(0, first); // now and then, not with every row
    }
    this.#scheduleDraw();
  }

  /** @param {PlotRow[]} rows */
  set(rows) {
    this.#rows = rows;
    this.#scheduleDraw();
  }

  /**
   * Mark an instant [s] and show its values; null: none, and those of the newest row.
   * @param {number | null} time
   */
  setCursor(time) {
    this.#cursorTime = time;
    this.#showValues();
    for (const { plot } of this.plots) plot.setCursor(time);
  }

  /** @param {typeof PLOTS[number]} plot */
  #createPlot({ name, title, series = this.joints, yRange, limits }) {
    const styled = series.map((label, i) => ({ label, color: series === this.joints ? `--joint-${i}` : "--accent" }));
    const plot = new LinePlot(this.element, {
      title,
      label: `${title}, against time`,
      series: styled,
      height: HEIGHT,
      yRange,
      limits,
      xUnit: "s",
    });
    return { name, series, plot };
  }

  // Once a frame, whatever came meanwhile; nothing while it cannot be seen.
  #scheduleDraw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      if (this.element.offsetParent) this.#draw();
    });
  }

  #draw() {
    const rows = this.#rows;
    const times = rows.map((row) => row.time);
    const [first, last] = [times[0], times[times.length - 1]];
    /** @type {[number, number] | null} */
    const xRange =
      this.window && times.length ? [Math.max(first, last - this.window), Math.max(last, first + 1)] : null;
    for (const { name, series, plot } of this.plots)
      plot.setData([times, ...series.map((_, i) => rows.map((row) => row[name][i]))], xRange);
    this.#showValues();
  }

  // The legend, with the figures that a canvas does not tell a screen reader.
  #showValues() {
    const rows = this.#rows;
    const time = this.#cursorTime ?? Infinity;
    const row = rows.findLast((one) => one.time <= time) ?? rows[0];
    if (!row) return;
    const [error, lateness] = [row.error[0], row.lateness[0]];
    patchChildren(
      this.#values,
      this.joints.map((name, i) =>
        valueRow(name, `${formatValue(row.positions[i], 1)}°`, `${formatValue(row.speeds[i], 0)}\u202f%`, `joint-${i}`),
      ),
      valueRow("tracking error", error === null ? "–" : `${formatValue(error, 2)}\u202fmrad`),
      valueRow("lateness", lateness === null ? "–" : `${formatValue(lateness, 0)}\u202fµs`),
    );
  }
}

/** @param {string} name @param {string} value @param {string} speed @param {string} className */
function valueRow(name, value, speed = "", className = "") {
  return [
    element("dt", { class: className }, className && element("span", { class: "swatch" }), name),
    element("dd", {}, value, speed && element("span", {}, speed)),
  ];
}

/**
 * Without the sign of a zero; nothing where there is no value.
 * @param {number | null} value
 * @param {number} digits
 */
const formatValue = (value, digits) => (value === null ? "–" : value.toFixed(digits)).replace(/^-(0\.?0*)$/, "$1");

/** @type {import("../line_plot.js").YRange} */
function padded(low, high) {
  if (low === null) return [-1, 1]; // there is no data
  const margin = Math.max((high - low) * 0.08, 1);
  return [low - margin, high + margin];
}

/**
 * A range from zero that reaches at least so far.
 * @param {number} least
 * @returns {import("../line_plot.js").YRange}
 */
function fromZero(least) {
  return (_, high) => [0, Math.max(high * 1.1, least)];
}
