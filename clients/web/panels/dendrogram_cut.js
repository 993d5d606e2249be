// The dendrogram: how the demonstrations merge, with a cut that can be dragged to make more ways or fewer.
import { get, post, resourcePath } from "../api.js";
import { element, formatNumber, patchChildren, pluralize } from "../elements.js";
import { selectedRun } from "../store.js";
import { Dendrogram } from "./dendrogram.js";
import { markFocus, trackFocus } from "./focus.js";

export function dendrogramCut(place, { store, attempt }) {
  const tree = new Dendrogram();
  const slider = element("input", {
    type: "range",
    min: "0",
    max: "1",
    step: "any",
    "aria-label": "height of the cut",
  });
  const output = element("output", {});
  const buttons = element("p", { class: "buttons" });
  const requested = new Set();
  let shown = null; // the dendrogram and its run
  let height = 0;
  place.append(tree.element, element("label", { class: "cut" }, "Cut ", slider, output), buttons);
  trackFocus(tree.element, store);

  const move = (to) => {
    height = Math.min(Math.max(to, shown.top / 1000), shown.top);
    const chosen = cutAt(shown.dendrogram, height);
    slider.value = String(height / shown.top);
    const count = chosen?.clusters ?? shown.dendrogram.leaves.length;
    output.textContent = `${count} ${pluralize(count, "way")}, at ${formatNumber(height * 100, 1, "cm")}`;
    slider.setAttribute("aria-valuetext", output.textContent);
    tree.color(chosen, height);
    const same = count === shown.dendrogram.clusters;
    patchChildren(
      buttons,
      !same &&
        chosen &&
        element(
          "button",
          { type: "button", class: "primary", "data-cut": "1", "data-key": "cut" },
          `Make ${count} ${pluralize(count, "way")}`,
        ),
      !same && element("button", { type: "button", "data-back": "1", "data-key": "back" }, "Put it back"),
    );
  };
  slider.addEventListener("input", () => shown && move(Number(slider.value) * shown.top));
  tree.onDrag = (to) => move(to);
  buttons.addEventListener("click", (event) => {
    const { cut: make, back } = event.target.closest("button")?.dataset ?? {};
    if (back) move(shown.dendrogram.threshold);
    if (make)
      attempt(() =>
        post(resourcePath("tasks", store.state.task, "jobs"), { kind: "recut", run: shown.run, threshold: height }),
      );
  });

  // Only the cut of the run that is looked at can be moved, so that no dendrogram that comes later undoes it.
  const ready = (run) => {
    const known = shown?.run === run;
    slider.disabled = !known;
    for (const part of [tree.element, buttons]) part.inert = !known;
  };
  const show = (state, run, dendrogram) => {
    const highest = dendrogram.merges.at(-1)?.[2] ?? 0;
    shown = { run, dendrogram, top: 1.12 * Math.max(highest, dendrogram.threshold) || 1 };
    const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
    tree.draw(dendrogram, shown.top, numbers);
    move(dendrogram.threshold);
    ready(run);
  };
  return {
    async update(state) {
      markFocus(place, state.focus); // also on what has just been drawn anew
      const run = selectedRun(state);
      place.parentElement.hidden = !(run?.learned.demonstrations.length > 1);
      ready(run?.id);
      if (place.parentElement.hidden || run.id === shown?.run || requested.has(run.id) || !state.demonstrations) return;
      requested.add(run.id);
      const dendrogram = await attempt(() => get(resourcePath("tasks", state.task, "runs", run.id, "dendrogram")));
      requested.delete(run.id);
      if (dendrogram && selectedRun(store.state)?.id === run.id) show(store.state, run.id, dendrogram);
    },
  };
}

// The listed cut that a height falls into; null below the lowest that is listed.
function cutAt(dendrogram, height) {
  return dendrogram.cuts.find((one) => height >= one.lowest && (one.highest === null || height < one.highest)) ?? null;
}
