// A motion as a ghost in the view: played in real time, or looked at at any instant.
import { element, number } from "../elements.js";

export class Player {
  motion = null; // as in motion.js, while it is open
  ghost = null;
  #stop = null; // what ends the playing

  // `instant` names the slider, `shut` the button that closes; `more`: further elements below them. `shown(seconds)` is
  // called with every instant and returns further words about it; `closed()` when it was open.
  constructor({ instant, shut, more = [], shown = () => "", closed = () => {} }) {
    Object.assign(this, { shown, closed });
    this.scrub = element("input", { type: "range", min: "0", max: "1", step: "0.01", value: "0", "aria-label": instant });
    this.words = element("output", { class: "words" });
    this.play = element("button", { type: "button" }, "Play");
    const close = element("button", { type: "button" }, shut);
    this.element = element("div", { class: "scrub", hidden: "" }, this.scrub, this.words, element("p", { class: "orders" }, this.play, close), more);
    close.addEventListener("click", () => this.close());
    this.play.addEventListener("click", () => (this.#stop ? this.pause() : this.start()));
    this.scrub.addEventListener("input", () => {
      this.pause();
      this.show(Number(this.scrub.value));
    });
  }

  open(motion, ghost) {
    this.close();
    Object.assign(this, { motion, ghost });
    this.scrub.max = String(motion.duration);
    this.element.hidden = false;
  }

  close() {
    if (!this.motion) return;
    this.pause();
    this.ghost.remove();
    this.ghost = this.motion = null;
    this.element.hidden = true;
    this.closed();
  }

  // From where the slider is, or from the beginning when it is at the end.
  start() {
    const { duration } = this.motion;
    const from = Number(this.scrub.value) >= duration - 0.01 ? 0 : Number(this.scrub.value);
    const began = performance.now() - 1000 * from;
    const next = () => {
      const seconds = Math.min((performance.now() - began) / 1000, duration);
      this.show(seconds);
      if (seconds < duration) this.#stop = requestAnimationFrame(next);
      else this.pause();
    };
    this.#stop = requestAnimationFrame(next);
    this.play.textContent = "Pause";
  }

  pause() {
    cancelAnimationFrame(this.#stop);
    this.#stop = null;
    this.play.textContent = "Play";
  }

  show(seconds) {
    const here = this.motion.at(seconds);
    this.ghost.place(here.q, here);
    this.scrub.value = String(seconds);
    const more = this.shown(seconds, here);
    const words = `${number(seconds, 1, "s")} of ${number(this.motion.duration, 1, "s")}${more && `: ${more}`}`;
    this.scrub.setAttribute("aria-valuetext", words);
    this.words.textContent = words;
  }
}
