// A line plot in the page's colours; uPlot draws it on a canvas, so what it shows is also said in words.
import uPlot from "./vendor/uplot/uPlot.esm.js";
import { element } from "./elements.js";

const HEIGHT = 150; // [px]
const dark = matchMedia("(prefers-color-scheme: dark)");

// Draw in `place` instead of what was there: data = [x, y of each series]; series = [{label, color, points}]; points:
// marks without a line. `label` says in words what is seen. Returns the uPlot, whose setData() takes newer data.
export function plot(place, { title, label, data, series, height = HEIGHT }) {
  place.plotted?.destroy();
  place.plotAgain ??= dark.addEventListener("change", () => place.plotAnew?.()) ?? true;
  place.plotAnew = () => plot(place, { title, label, data, series, height });
  const [ink, rule] = ["--faint", "--line"].map((name) => getComputedStyle(place).getPropertyValue(name));
  const axis = { stroke: ink, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 }, font: "11px system-ui" };
  const drawn = element("div", { role: "img", "aria-label": label });
  place.replaceChildren(element("p", { class: "plot-title" }, title), drawn);
  place.plotted = new uPlot(
    {
      width: Math.max(200, place.clientWidth),
      height,
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { show: false } },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 24 }, { ...axis, size: 48 }],
      series: [{}, ...series.map((one) => look(one))],
    },
    data,
    drawn,
  );
  return place.plotted;
}

function look({ label, color, points }) {
  const stroke = `#${color.toString(16).padStart(6, "0")}`;
  return { label, stroke, width: 2, spanGaps: false, ...(points ? { paths: () => null, points: { show: true, size: 8, fill: stroke } } : { points: { show: false } }) };
}
