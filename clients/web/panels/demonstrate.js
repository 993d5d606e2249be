// Demonstrate: who is there, what is being recorded, and the demonstrations so far with their verdicts.
import { section } from "../elements.js";
import { recordings } from "./recordings.js";
import { takes } from "./takes.js";

let parts = [];

export const panel = {
  id: "demonstrate",
  title: "Demonstrate",

  mount(place, context) {
    parts = [
      recordings(section(place, "recordings", "Recording"), context),
      takes(section(place, "demonstrations", "Demonstrations"), context),
    ];
  },

  update(state, changed) {
    for (const part of parts) part.update(state, changed);
  },
};
