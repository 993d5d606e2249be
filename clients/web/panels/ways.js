// Ways: what was learned, as a choice between the ways in which the task was done, and why.
import { cards } from "./cards.js";
import { cut } from "./cut.js";
import { jobs } from "./jobs.js";
import { composed } from "./parts.js";
import { scores } from "./scores.js";
import { selection } from "./selection.js";

export const panel = composed("ways", "Ways", [
  ["work", "At work", jobs],
  ["learned", "Ways of doing it", cards],
  ["cut", "Where the ways part", cut],
  ["selection", "Who agrees", selection],
  ["scores", "How the models learned", scores],
]);
