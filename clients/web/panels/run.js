// Run: preview as a ghost, then the arm itself, its joints as they move, and what was executed before.
import { section } from "../elements.js";
import { control } from "./control.js";
import { live } from "./live.js";
import { preview } from "./preview.js";
import { replay } from "./replay.js";

let parts = [];

export const panel = {
  id: "run",
  title: "Run",

  mount(place, context) {
    parts = [
      preview(section(place, "preview", "Preview"), context),
      control(section(place, "arm", "Arm"), context),
      live(section(place, "joints", "Joints"), context),
      replay(section(place, "replay", "Past executions"), context),
    ];
  },

  update(state, changed) {
    for (const part of parts) part.update(state, changed);
  },

  show() {
    for (const part of parts) part.show?.();
  },

  hide() {
    for (const part of parts) part.hide?.();
  },

  // Poses of the links of the ghosts as drawn, of the preview and of the replay, or null: for tests, and the curious.
  ghost: () => parts[0].panel.ghost?.frames() ?? null,
  replayed: () => parts[3].panel.ghost?.frames() ?? null,
};
