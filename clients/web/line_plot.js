// A line plot in the page's colours. uPlot draws it on a canvas, which no screen reader reads: `label` says what it shows.
// The library comes when the first plot is drawn: nobody needs it to see the arm.
import { element } from "./elements.js";

/** @import uPlot from "uplot" */

const HEIGHT = 150; // [px]
const FONT = "11px system-ui, sans-serif";
const dark = matchMedia("(prefers-color-scheme: dark)");

/**
 * @typedef {object} Series
 * @property {string} label
 * @property {string} color a variable of the style sheet, e.g. "--way-0"
 * @property {boolean} [points] marks without a line
 *
 * @typedef {(low: number, high: number) => [number, number]} YRange of the range of the data
 *
 * @typedef {object} PlotOptions
 * @property {string} title
 * @property {string} [label]
 * @property {Series[]} series
 * @property {number} [height]
 * @property {[number, number] | YRange} [yRange]
 * @property {number[]} [limits] y of dashed lines
 * @property {string} [xUnit] at the ticks
 */

export class LinePlot {
  /** @type {uPlot | null} */
  #chart = null;
  #isRemoved = false;
  /** @type {uPlot.AlignedData} */
  #data;
  /** @type {[number, number] | null} */
  #xRange = null;
  #rebuild = () => this.#build();

  /** @param {HTMLElement} place @param {PlotOptions} options */
  constructor(place, { title, label = title, series, height = HEIGHT, yRange, limits = [], xUnit = "" }) {
    this.series = series;
    this.height = height;
    this.yRange = yRange;
    this.limits = limits;
    this.xUnit = xUnit;
    this.#data = [[], ...series.map(() => [])];
    this.canvas = element("div", { role: "img", "aria-label": label });
    this.element = element("div", { class: "line-plot" }, element("h3", {}, title), this.canvas);
    place.append(this.element);
    this.#build();
    this.resize = new ResizeObserver(() => this.#fit());
    this.resize.observe(this.element);
    dark.addEventListener("change", this.#rebuild);
  }

  /**
   * @param {uPlot.AlignedData} data x, and y of each series
   * @param {[number, number] | null} xRange of what is shown, or null for all
   */
  setData(data, xRange = null) {
    this.#data = data;
    this.#xRange = xRange;
    this.#chart?.setData(data);
    if (xRange) this.#chart?.setScale("x", { min: xRange[0], max: xRange[1] });
  }

  /**
   * Mark a place on the x axis; null: none.
   * @param {number | null} x
   */
  setCursor(x) {
    const left = x === null ? -10 : (this.#chart?.valToPos(x, "x") ?? -10);
    this.#chart?.setCursor({ left, top: 0 }, false);
  }

  remove() {
    this.#isRemoved = true;
    dark.removeEventListener("change", this.#rebuild);
    this.resize.disconnect();
    this.#chart?.destroy();
    this.element.remove();
  }

  // The colours are read from the style sheet when the chart is made: another theme needs another chart.
  async #build() {
    const { default: Chart } = await import("./vendor/uplot/uPlot.esm.js");
    if (this.#isRemoved) return;
    this.#chart?.destroy();
    const style = getComputedStyle(document.documentElement);
    /** @param {string} name */
    const color = (name) => style.getPropertyValue(name).trim();
    const axis = {
      stroke: color("--faint"),
      grid: { stroke: color("--line"), width: 1 },
      ticks: { show: false },
      font: FONT,
    };
    /** @param {uPlot} _ @param {number[]} ticks */
    const xTicks = (_, ticks) => ticks.map((tick) => `${tick}${this.xUnit && ` ${this.xUnit}`}`);
    this.#chart = new Chart(
      {
        width: 300,
        height: this.height,
        legend: { show: false },
        cursor: { y: false, points: { show: false }, drag: { x: false, y: false } },
        scales: { x: { time: false }, y: this.#yScale() },
        axes: [
          { ...axis, size: 24, values: xTicks },
          { ...axis, size: yAxisWidth },
        ],
        series: [{}, ...this.series.map((one) => seriesStyle(one, color(one.color)))],
        hooks: { draw: [(chart) => drawLimits(chart, this.limits, color("--bad"))] },
      },
      this.#data,
      this.canvas,
    );
    this.setData(this.#data, this.#xRange);
    this.#fit();
  }

  /** @returns {uPlot.Scale} */
  #yScale() {
    const { yRange } = this;
    if (!yRange) return {};
    if (Array.isArray(yRange)) return { range: yRange };
    /** @type {uPlot.Range.Function} */
    const range = (_, low, high) => yRange(low, high);
    return { range };
  }

  #fit() {
    const width = this.element.clientWidth;
    if (width > 0 && width !== this.#chart?.width) this.#chart?.setSize({ width, height: this.height });
  }
}

/** @type {uPlot.Axis.Size} room for the longest label [px] */
const yAxisWidth = (_, labels) =>
  Math.max(48, 14 + 6 * Math.max(0, ...(labels ?? []).map((text) => text?.length ?? 0)));

/** @param {Series} series @param {string} stroke @returns {uPlot.Series} */
function seriesStyle({ label, points }, stroke) {
  const style = { label, stroke, width: 1.5, spanGaps: false };
  if (points) return { ...style, paths: () => null, points: { show: true, size: 8, fill: stroke } };
  return { ...style, points: { show: false } };
}

/** @param {uPlot} chart @param {number[]} values @param {string} color */
function drawLimits(chart, values, color) {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.strokeStyle = color;
  ctx.setLineDash([6, 4]);
  for (const value of values) {
    const y = chart.valToPos(value, "y", true);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  }
  ctx.restore();
}
