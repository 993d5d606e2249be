// The dendrogram: how the demonstrations merge, with a cut that can be dragged to make more ways or fewer.
import { get, post, resourcePath } from "../api.js";
import { block, closestData, element, hideSection } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { demonstrationNumbers } from "../store.js";
import { formatNumber, pluralize } from "../texts.js";
import { DendrogramView } from "./dendrogram.js";
import { markFocus, trackFocus } from "./focus.js";

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function dendrogramCut(place, context) {
  const panel = new DendrogramCut(place, context);
  return { update: (state) => panel.update(state) };
}

class DendrogramCut {
  /** @type {Set<string>} */
  #requested = new Set();
  /** @type {{run: string, dendrogram: Dendrogram, top: number} | null} */
  #shown = null;
  #height = 0; // [m] of the cut

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.place = place;
    this.context = context;
    this.view = new DendrogramView((height) => this.#move(height));
    const range = { type: "range", min: "0", max: "1", step: "any", "aria-label": "height of the cut" };
    this.slider = element("input", range);
    this.output = element("output", {});
    this.buttons = element("p", { class: "buttons" });
    place.append(this.view.element, element("label", { class: "cut" }, "Cut ", this.slider, this.output), this.buttons);
    trackFocus(this.view.element, context.store);
    this.slider.addEventListener("input", () => this.#move(Number(this.slider.value) * (this.#shown?.top ?? 0)));
    this.buttons.addEventListener("click", (event) => {
      const { cut, back } = closestData(event);
      if (back && this.#shown) this.#move(this.#shown.dendrogram.threshold);
      if (cut) context.attempt(() => this.#recut());
    });
  }

  /** @param {State} state */
  async update(state) {
    markFocus(this.place, state.focus); // also on what has just been drawn anew
    const run = state.selectedRun;
    const isUseful = run !== null && run.learned.demonstrations.length > 1;
    hideSection(this.place, !isUseful);
    this.#enable(run?.id);
    if (!isUseful || run.id === this.#shown?.run || this.#requested.has(run.id) || !state.demonstrations) return;
    this.#requested.add(run.id);
    const path = resourcePath("tasks", state.task, "runs", run.id, "dendrogram");
    /** @type {Dendrogram | undefined} */
    const dendrogram = await this.context.attempt(() => get(path));
    this.#requested.delete(run.id);
    const now = this.context.store.state;
    if (dendrogram && now.selectedRun?.id === run.id) this.#show(now, run.id, dendrogram);
  }

  /**
   * Only the cut of the run that is looked at can be moved, so that no dendrogram that comes later undoes it.
   * @param {string | undefined} run
   */
  #enable(run) {
    const isKnown = this.#shown?.run === run;
    block(this.slider, isKnown ? "" : "The tree of this run has not been read yet.");
    for (const part of [this.view.element, this.buttons]) part.inert = !isKnown;
  }

  /** @param {State} state @param {string} run @param {Dendrogram} dendrogram */
  #show(state, run, dendrogram) {
    const highest = dendrogram.merges.at(-1)?.[2] ?? 0;
    const top = 1.12 * Math.max(highest, dendrogram.threshold) || 1;
    this.#shown = { run, dendrogram, top };
    this.view.draw(dendrogram, top, demonstrationNumbers(state));
    this.#move(dendrogram.threshold);
    this.#enable(run);
  }

  /** @param {number} to height [m] */
  #move(to) {
    if (!this.#shown) return;
    const { dendrogram, top } = this.#shown;
    this.#height = Math.min(Math.max(to, top / 1000), top);
    const cut = cutAt(dendrogram, this.#height);
    const count = cut?.clusters ?? dendrogram.leaves.length;
    const ways = `${count} ${pluralize(count, "way")}`;
    this.slider.value = String(this.#height / top);
    this.output.textContent = `${ways}, at ${formatNumber(this.#height * 100, 1, "cm")}`;
    this.slider.setAttribute("aria-valuetext", this.output.textContent);
    this.view.color(cut, this.#height);
    const differs = count !== dendrogram.clusters;
    const make = { type: "button", class: "primary", "data-cut": "1", "data-key": "cut" };
    patchChildren(
      this.buttons,
      differs && cut && !this.context.readOnly && element("button", make, `Make ${ways}`),
      differs && element("button", { type: "button", "data-back": "1", "data-key": "back" }, "Put it back"),
    );
  }

  async #recut() {
    if (!this.#shown) return;
    const { store } = this.context;
    const order = { kind: "recut", run: this.#shown.run, threshold: this.#height };
    await post(resourcePath("tasks", store.state.task, "jobs"), order);
  }
}

/**
 * The listed cut that a height falls into; null below the lowest that is listed.
 * @param {Dendrogram} dendrogram
 * @param {number} height [m]
 */
function cutAt({ cuts }, height) {
  return cuts.find(({ lowest, highest }) => height >= lowest && (highest === null || height < highest)) ?? null;
}
