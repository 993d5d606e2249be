// Ways: what was learned, as a choice between the ways in which the task was done, and why.

import { dendrogramCut } from "./dendrogram_cut.js";
import { jobList } from "./jobs.js";
import { likelihoodPlots } from "./likelihood_plots.js";
import { pathCards } from "./path_cards.js";
import { sectionedPanel } from "./sectioned_panel.js";
import { selectionTable } from "./selection_table.js";

export const panel = sectionedPanel("ways", "Ways", [
  ["work", "At work", jobList],
  ["learned", "Ways of doing it", pathCards],
  ["cut", "Where the ways part", dendrogramCut],
  ["selection", "Who agrees", selectionTable],
  ["scores", "How the models learned", likelihoodPlots],
]);
