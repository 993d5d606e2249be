// The message line: every error with what to do, every outcome worth a word, perhaps with its undo; read aloud by screen readers,
// for which it is always there: of one that appears together with its text some read nothing.
import { element } from "./elements.js";

const NOTE_DURATION = 6000; // [ms] of a note; an error stays until it is closed or another attempt succeeds

/** @typedef {{label: string, order: () => Promise<unknown>}} Action */

export class Messages {
  #said = 0; // sentences so far
  #timer = 0;

  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /**
   * @param {string} text
   * @param {string} kind "note" or "error"
   * @param {Action | null} action offered with it; it stays until it is closed then
   */
  show(text, kind = "note", action = null) {
    clearTimeout(this.#timer);
    this.#said += 1;
    const close = element("button", { type: "button", class: "close", "aria-label": "Close this message" }, "×");
    close.addEventListener("click", () => this.clear());
    // an error interrupts the screen reader, a note waits its turn
    this.place.setAttribute("role", kind === "error" ? "alert" : "status");
    this.place.replaceChildren(element("p", { class: kind }, text), ...(action ? [this.#button(action)] : []), close);
    if (kind === "note" && !action) this.#timer = setTimeout(() => this.clear(), NOTE_DURATION);
  }

  /** @param {Action} action */
  #button({ label, order }) {
    const button = element("button", { type: "button" }, label);
    button.addEventListener("click", () => this.attempt(order));
    return button;
  }

  clear() {
    clearTimeout(this.#timer);
    this.place.replaceChildren();
  }

  /**
   * Do `order`; show its error as a sentence. Returns what it returned, or undefined. What was said after it began stays.
   * @template T
   * @param {() => T | Promise<T>} order
   * @returns {Promise<T | undefined>}
   */
  async attempt(order) {
    const before = this.#said;
    try {
      const outcome = await order();
      if (this.#said === before) this.clear();
      return outcome;
    } catch (error) {
      this.show(error instanceof Error ? error.message : String(error), "error");
      if (error instanceof TypeError || error instanceof ReferenceError) throw error; // a fault of ours
      return undefined;
    }
  }
}
