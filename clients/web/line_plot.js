// A line plot in the page's colours. uPlot draws it on a canvas, which no screen reader reads: `label` says what it shows.

import { element } from "./elements.js";
import uPlot from "./vendor/uplot/uPlot.esm.js";

const HEIGHT = 150; // [px]
const FONT = "11px system-ui, sans-serif";
const dark = matchMedia("(prefers-color-scheme: dark)");

export class LinePlot {
  #chart = null;
  #data;
  #xRange = null;
  #rebuild = () => this.#build();

  // `series`: [{label, color, points}]; `color` is a variable of the style sheet, e.g. "--way-0"; `points`: marks without a
  // line. `yRange`: [low, high], or a function of the data's own; `limits`: y of dashed lines; `xUnit` stands at the ticks.
  constructor(place, { title, label = title, series, height = HEIGHT, yRange = null, limits = [], xUnit = "" }) {
    Object.assign(this, { series, height, yRange, limits, xUnit });
    this.#data = [[], ...series.map(() => [])];
    this.canvas = element("div", { role: "img", "aria-label": label });
    this.element = element("div", { class: "line-plot" }, element("h3", {}, title), this.canvas);
    place.append(this.element);
    this.#build();
    this.resize = new ResizeObserver(() => this.#fit());
    this.resize.observe(this.element);
    dark.addEventListener("change", this.#rebuild);
  }

  // `data`: x, and y of each series; `xRange`: [from, to] of what is shown, or null for all.
  setData(data, xRange = null) {
    this.#data = data;
    this.#xRange = xRange;
    this.#chart.setData(data);
    if (xRange) this.#chart.setScale("x", { min: xRange[0], max: xRange[1] });
  }

  // Mark a place on the x axis; null: none.
  setCursor(x) {
    this.#chart.setCursor({ left: x === null ? -10 : this.#chart.valToPos(x, "x"), top: 0 }, false);
  }

  remove() {
    dark.removeEventListener("change", this.#rebuild);
    this.resize.disconnect();
    this.#chart.destroy();
    this.element.remove();
  }

  // The colours are read from the style sheet when the chart is made: another theme needs another chart.
  #build() {
    this.#chart?.destroy();
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const axis = {
      stroke: color("--faint"),
      grid: { stroke: color("--line"), width: 1 },
      ticks: { show: false },
      font: FONT,
    };
    const xTicks = (_, ticks) => ticks.map((tick) => `${tick}${this.xUnit && ` ${this.xUnit}`}`);
    this.#chart = new uPlot(
      {
        width: 300,
        height: this.height,
        legend: { show: false },
        cursor: { y: false, points: { show: false }, drag: { x: false, y: false } },
        scales: { x: { time: false }, y: this.#yScale() },
        axes: [
          { ...axis, size: 24, values: xTicks },
          { ...axis, size: 48 },
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

  #yScale() {
    const { yRange } = this;
    if (!yRange) return {};
    return { range: Array.isArray(yRange) ? yRange : (_, low, high) => yRange(low, high) };
  }

  #fit() {
    const width = this.element.clientWidth;
    if (width > 0 && width !== this.#chart.width) this.#chart.setSize({ width, height: this.height });
  }
}

function seriesStyle({ label, points }, stroke) {
  const style = { label, stroke, width: 1.5, spanGaps: false };
  if (points) return { ...style, paths: () => null, points: { show: true, size: 8, fill: stroke } };
  return { ...style, points: { show: false } };
}

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
