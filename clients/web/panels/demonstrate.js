// Demonstrate: who is there, what is being recorded, and the demonstrations so far with their verdicts.
import { section } from "../elements.js";
import { demonstrationList } from "./demonstration_list.js";
import { demonstrationPanel } from "./demonstration_panel.js";
import { recordingList } from "./recordings.js";

let sections = [];

export const panel = {
  id: "demonstrate",
  title: "Demonstrate",

  mount(place, context) {
    sections = [
      demonstrationPanel(section(place, "demonstration-session", "Show it here"), context),
      recordingList(section(place, "recordings", "Recording"), context),
      demonstrationList(section(place, "demonstrations", "Demonstrations"), context),
    ];
  },

  // The headset that is worn now, or null, and the demonstration session, or null: for tests.
  headset: () => sections[0].headset(),
  session: () => sections[0].session(),

  update(state, changed) {
    for (const one of sections) one.update(state, changed);
  },
};
