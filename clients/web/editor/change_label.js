// Says beside the points that are dragged how far they have come, while they are.
import { element } from "../elements.js";
import { formatNumber } from "../texts.js";

const AXES = ["x", "y", "z"];
const MIN_CHANGE = 0.0005; // [m] a change that is said
const OFFSET = 18; // [px] from the point, so that neither it nor its handles are covered

export class ChangeLabel {
  /** @param {import("../overlay.js").Overlay} overlay */
  constructor(overlay) {
    this.overlay = overlay;
    this.element = element("p", { class: "change-label", "aria-hidden": "true", hidden: "" }); // the fields say it to a screen reader
    overlay.element.append(this.element);
  }

  /** @param {number[]} by [m] since the drag began @param {Point} at */
  show(by, at) {
    const pixel = this.overlay.project(at);
    const text = changeText(by);
    this.element.hidden = !pixel || !text;
    if (!pixel) return;
    const { left, top } = this.overlay.element.getBoundingClientRect();
    this.element.textContent = text;
    this.element.style.transform = `translate(${Math.round(pixel[0] - left + OFFSET)}px, ${Math.round(pixel[1] - top + OFFSET)}px)`;
  }

  hide() {
    this.element.hidden = true;
  }
}

/** How far something has come, in millimetres along the axes in which it has. @param {number[]} by [m] */
export function changeText(by) {
  const parts = by.flatMap((value, k) => (Math.abs(value) < MIN_CHANGE ? [] : [`${AXES[k]} ${signed(1000 * value)}`]));
  return parts.length ? `${parts.join("  ")}\u202fmm` : "";
}

/** @param {number} value */
const signed = (value) => `${value < 0 ? "−" : "+"}${formatNumber(Math.abs(value), 0)}`;
