// Plots of the joints against time: positions, velocities against their limits, tracking error and lateness.
import { element, replace } from "../elements.js";
import uPlot from "../vendor/uplot/uPlot.esm.js";

const HEIGHT = 132; // [px] of one plot
const DEGREES = 180 / Math.PI;
const COLORS = ["--way-0", "--way-1", "--way-2", "--way-3", "--way-4", "--way-5"];

const JOINTS = [1, 2, 3, 4, 5, 6].map((joint) => `joint ${joint}`);
const PLOTS = [
  { name: "positions", title: "Joint positions [°]", series: JOINTS },
  { name: "speeds", title: "Joint speeds, share of the limit [%]", series: JOINTS, range: [-105, 105], limits: [-100, 100] },
  { name: "error", title: "Tracking error, largest over the joints [mrad]", series: ["tracking error"], least: 1 },
  { name: "lateness", title: "Lateness of the setpoints [µs]", series: ["lateness"], least: 100 },
];

// One row of all plots; position [rad], speed [rad/s] with the limits of GET /robot, error [rad], lateness [s] or null.
export function row(arm, { time, position, speed, error, lateness }) {
  return {
    time,
    positions: position.map((value) => value * DEGREES),
    speeds: speed.map((value, i) => (100 * value) / arm.speed[i]),
    error: [error === null ? null : 1000 * error],
    lateness: [lateness === null ? null : 1e6 * lateness],
  };
}

export class Plots {
  #charts = [];
  #rows = [];
  #values;
  marked = null; // [s]

  // `window` [s] of the newest rows is shown; 0: all of them.
  constructor(place, { window = 0 } = {}) {
    this.window = window;
    this.place = element("div", { class: "plots" });
    place.append(this.place);
    this.#values = element("dl", { class: "values" });
    this.#charts = PLOTS.map((plot) => this.#chart(plot));
    this.place.append(this.#values);
    new ResizeObserver(() => this.#fit()).observe(this.place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#rebuild());
  }

  add(row) {
    if (this.#rows.length && row.time <= this.#rows.at(-1).time) this.#rows = []; // another execution
    this.#rows.push(row);
    if (this.window) {
      const first = this.#rows.findIndex((one) => one.time >= row.time - this.window);
      if (first > 50) this.#rows.splice(0, first); // now and then, not with every row
    }
    this.#later();
  }

  set(rows) {
    this.#rows = rows;
    this.#later();
  }

  // Mark an instant [s] and tell its values; null: none, and those of the newest row.
  mark(time) {
    this.marked = time;
    this.#tell();
    for (const { chart } of this.#charts) {
      const left = time === null ? -10 : chart.valToPos(time, "x");
      chart.setCursor({ left, top: 0 }, false);
    }
  }

  // Once a frame, whatever came meanwhile; nothing while it cannot be seen.
  #later() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      if (this.place.offsetParent) this.#draw();
    });
  }

  #draw() {
    const rows = this.#rows;
    const times = rows.map((one) => one.time);
    for (const { plot, chart } of this.#charts) {
      chart.setData([times, ...plot.series.map((_, i) => rows.map((one) => one[plot.name][i]))]);
      if (this.window && times.length) chart.setScale("x", { min: Math.max(times[0], times.at(-1) - this.window), max: Math.max(times.at(-1), times[0] + 1) });
    }
    this.#tell();
  }

  // The legend, with the figures that a canvas does not tell a screen reader.
  #tell() {
    const rows = this.#rows;
    const here = this.marked === null ? rows.at(-1) : (rows.findLast((one) => one.time <= this.marked) ?? rows[0]);
    if (!here) return;
    const [error, late] = [here.error[0], here.lateness[0]];
    const values = [
      ...JOINTS.map((name, i) => [name, `${plain(here.positions[i], 1)}°`, `${plain(here.speeds[i], 0)}\u202f%`, `joint-${i}`]),
      ["tracking error", error === null ? "–" : `${plain(error, 2)}\u202fmrad`, "", ""],
      ["lateness", late === null ? "–" : `${plain(late, 0)}\u202fµs`, "", ""],
    ];
    const line = ([name, value, speed, looks]) => [element("dt", { class: looks }, looks && element("span", { class: "swatch" }), name), element("dd", {}, value, speed && element("span", {}, speed))];
    replace(this.#values, values.map(line));
  }

  #chart(plot) {
    const holder = element("div", { role: "img", "aria-label": `${plot.title}, against time` });
    this.place.append(element("h3", {}, plot.title), holder);
    return { plot, holder, chart: this.#make(plot, holder) };
  }

  #make(plot, holder) {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const axis = { stroke: color("--faint"), grid: { stroke: color("--line"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const range = plot.range ?? ((_, low, high) => (plot.least ? [0, Math.max(high * 1.1, plot.least)] : pad(low, high)));
    return new uPlot(
      {
        width: 300,
        height: HEIGHT,
        legend: { show: false },
        cursor: { y: false, points: { show: false } },
        scales: { x: { time: false }, y: { range } },
        axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((tick) => `${tick} s`) }, { ...axis, size: 44 }],
        series: [{}, ...plot.series.map((label, i) => ({ label, stroke: color(COLORS[i]), width: 1.5, points: { show: false } }))],
        hooks: { draw: plot.limits ? [(chart) => limits(chart, plot.limits, color("--bad"))] : [] },
      },
      [[], ...plot.series.map(() => [])],
      holder,
    );
  }

  #fit() {
    const width = this.place.clientWidth;
    if (width > 0) for (const { chart } of this.#charts) chart.setSize({ width, height: HEIGHT });
    this.#later();
  }

  #rebuild() {
    for (const one of this.#charts) {
      one.chart.destroy();
      one.chart = this.#make(one.plot, one.holder);
    }
    this.#fit();
  }
}

// Without the sign of a zero.
const plain = (value, digits) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");

function pad(low, high) {
  if (low === null) return [-1, 1];
  const margin = Math.max((high - low) * 0.08, 1);
  return [low - margin, high + margin];
}

function limits(chart, values, color) {
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
