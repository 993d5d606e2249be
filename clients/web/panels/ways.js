// Ways: what was learned, as a choice between the ways in which the task was done, and why.
import { cards } from "./path_cards.js";
import { cut } from "./dendrogram_cut.js";
import { jobs } from "./jobs.js";
import { composed } from "./sectioned_panel.js";
import { scores } from "./likelihood_plots.js";
import { selection } from "./selection_table.js";

export const panel = composed("ways", "Ways", [
  ["work", "At work", jobs],
  ["learned", "Ways of doing it", cards],
  ["cut", "Where the ways part", cut],
  ["selection", "Who agrees", selection],
  ["scores", "How the models learned", scores],
]);
