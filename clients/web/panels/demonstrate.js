// Demonstrate: who is there, what is being recorded, and the demonstrations so far with their verdicts.
import { section } from "../elements.js";
import { recordings } from "./recordings.js";
import { show } from "./demonstration_panel.js";
import { takes } from "./demonstration_list.js";

let parts = [];

export const panel = {
  id: "demonstrate",
  title: "Demonstrate",

  mount(place, context) {
    parts = [
      show(section(place, "show", "Show it here"), context),
      recordings(section(place, "recordings", "Recording"), context),
      takes(section(place, "demonstrations", "Demonstrations"), context),
    ];
  },

  // The headset that is worn now, or null: for tests, and the curious.
  headset: () => parts[0].headset(),

  update(state, changed) {
    for (const part of parts) part.update(state, changed);
  },
};
