// Ways: what was learned, as a choice between the ways in which the task was done, and why.
import { section } from "../elements.js";
import { cards } from "./cards.js";
import { cut } from "./cut.js";
import { jobs } from "./jobs.js";
import { scores } from "./scores.js";
import { selection } from "./selection.js";

let parts = [];

export const panel = {
  id: "ways",
  title: "Ways",

  mount(place, context) {
    parts = [
      jobs(section(place, "work", "At work"), context),
      cards(section(place, "learned", "Ways of doing it"), context),
      cut(section(place, "cut", "Where the ways part"), context),
      selection(section(place, "selection", "Who agrees"), context),
      scores(section(place, "scores", "How the models learned"), context),
    ];
  },

  update(state, changed) {
    for (const part of parts) part.update(state, changed);
  },

  show() {
    for (const part of parts) part.show?.();
  },
};
