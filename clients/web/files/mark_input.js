// Taking and putting marked on the plot of a motion: by pointer, or by the arrow keys on a mark.
import { closest } from "../elements.js";
import { nearestMark, timeAt } from "./motion_plot.js";

const STEP = 0.02; // [s] that an arrow key moves a mark
/** @type {Record<string, number>} */
const KEY_STEPS = { ArrowLeft: -STEP, ArrowDown: -STEP, ArrowRight: STEP, ArrowUp: STEP };

/** @typedef {import("./motion_plot.js").Mark} Mark */

/**
 * Listen for marks on the plots in a place.
 * @param {HTMLElement} place
 * @param {object} plots
 * @param {(id: string) => number[] | undefined} plots.times of the motion of a file [s]
 * @param {(id: string) => import("./motion_plot.js").Marks} plots.marks that are shown
 * @param {(id: string, mark: Mark, time: number) => void} plots.onMark
 */
export function listenForMarks(place, { times, marks, onMark }) {
  /** @type {{id: string, mark: Mark} | null} */
  let dragged = null;
  place.addEventListener("pointerdown", (event) => {
    const plot = closest(event, "[data-plot]");
    const id = plot?.getAttribute("data-plot") ?? "";
    const known = times(id);
    if (!plot || !known || event.button !== 0) return;
    const pressed = /** @type {Mark | null} */ (closest(event, "[data-mark]")?.getAttribute("data-mark") ?? null);
    dragged = { id, mark: pressed ?? nearestMark(marks(id), timeAt(plot, event.clientX, known)) };
  });
  addEventListener("pointerup", (event) => {
    const ended = dragged;
    dragged = null;
    const plot = ended && place.querySelector(`[data-plot="${ended.id}"]`);
    const known = ended && times(ended.id);
    if (ended && plot && known) onMark(ended.id, ended.mark, timeAt(plot, event.clientX, known));
  });
  addEventListener("pointercancel", () => {
    dragged = null;
  });
  place.addEventListener("keydown", (event) => {
    const slider = closest(event, "[data-mark]");
    const step = KEY_STEPS[event.key];
    if (!slider || !step) return;
    event.preventDefault();
    const [now, end] = ["aria-valuenow", "aria-valuemax"].map((name) => Number(slider.getAttribute(name)));
    const time = Math.round(1000 * Math.min(Math.max(now + step, 0), end)) / 1000;
    onMark(slider.getAttribute("data-file") ?? "", /** @type {Mark} */ (slider.getAttribute("data-mark")), time);
  });
}
