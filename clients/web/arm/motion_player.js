// Shows a motion by a ghost arm in the view: played in real time, or at the instant of the slider.
import { element } from "../elements.js";
import { formatNumber } from "../texts.js";

/**
 * @typedef {object} PlayerOptions
 * @property {string} sliderLabel
 * @property {string} closeLabel
 * @property {Child[]} [children] below the slider
 * @property {(seconds: number, sample: import("./motion.js").MotionSample) => string} [describe] called with every instant;
 *   returns further words about it
 * @property {() => void} [onClose] called when it was open
 */

export class MotionPlayer {
  /** @type {import("./motion.js").Motion | null} */
  motion = null; // while it is open
  /** @type {import("./ghost_arm.js").GhostArm | null} */
  ghost = null;
  #animation = 0; // the requested frame while it plays

  /** @param {PlayerOptions} options */
  constructor({ sliderLabel, closeLabel, children = [], describe = () => "", onClose = () => {} }) {
    this.describe = describe;
    this.onClose = onClose;
    this.slider = element("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.01",
      value: "0",
      "aria-label": sliderLabel,
    });
    this.output = element("output", { class: "words" });
    this.play = element("button", { type: "button" }, "Play");
    const close = element("button", { type: "button" }, closeLabel);
    this.element = element(
      "div",
      { class: "player", hidden: "" },
      this.slider,
      this.output,
      element("p", { class: "buttons" }, this.play, close),
      children,
    );
    close.addEventListener("click", () => this.close());
    this.play.addEventListener("click", () => (this.#animation ? this.pause() : this.start()));
    this.slider.addEventListener("input", () => {
      this.pause();
      this.show(Number(this.slider.value));
    });
  }

  /** @param {import("./motion.js").Motion} motion @param {import("./ghost_arm.js").GhostArm} ghost */
  open(motion, ghost) {
    this.close();
    this.motion = motion;
    this.ghost = ghost;
    this.slider.max = String(motion.duration);
    this.element.hidden = false;
  }

  close() {
    if (!this.motion) return;
    this.pause();
    this.ghost?.remove();
    this.ghost = this.motion = null;
    this.element.hidden = true;
    this.onClose();
  }

  /** Play from where the slider is, or from the beginning when it is at the end. */
  start() {
    const { duration = 0 } = this.motion ?? {};
    const from = Number(this.slider.value) >= duration - 0.01 ? 0 : Number(this.slider.value);
    const began = performance.now() - 1000 * from;
    const next = () => {
      const seconds = Math.min((performance.now() - began) / 1000, duration);
      this.show(seconds);
      if (seconds < duration) this.#animation = requestAnimationFrame(next);
      else this.pause();
    };
    this.#animation = requestAnimationFrame(next);
    this.play.textContent = "Pause";
  }

  pause() {
    cancelAnimationFrame(this.#animation);
    this.#animation = 0;
    this.play.textContent = "Play";
  }

  /** @param {number} seconds */
  show(seconds) {
    if (!this.motion) return;
    const sample = this.motion.sample(seconds);
    this.ghost?.setPose(sample);
    this.slider.value = String(seconds);
    const description = this.describe(seconds, sample);
    const text = `${formatNumber(seconds, 1, "s")} of ${formatNumber(this.motion.duration, 1, "s")}${description && `: ${description}`}`;
    this.slider.setAttribute("aria-valuetext", text);
    this.output.textContent = text;
  }
}
