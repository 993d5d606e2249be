// Learning the ways of a task: what can be learned from, what is new since it was learned last, and the button that learns.
import { post, resourcePath } from "../api.js";
import { blocked, element } from "../elements.js";
import { icon } from "../icons.js";

const LEARNING_SENTENCE = "The task is being learned now.";

/** The demonstrations of the task that can be learned from. @param {State} state */
export const usableDemonstrations = ({ demonstrations }) =>
  (demonstrations ?? []).filter(
    ({ verdict, mark, discarded_ns }) => verdict !== "reject" && mark !== "bad" && !discarded_ns,
  );

/** How many of them the chosen run was not learned from. @param {State} state */
export function countFresh(state) {
  const learned = new Set(state.selectedRun?.learned.demonstrations ?? []);
  return usableDemonstrations(state).filter(({ id }) => !learned.has(id)).length;
}

/** @param {State} state @param {string} text @param {boolean} isNext whether it is what to do next */
export function learnButton({ jobs }, text, isNext = true) {
  const busy = (jobs ?? []).some(
    ({ state, kind }) => ["running", "queued"].includes(state) && ["learn", "recut"].includes(kind),
  );
  const data = { "data-learn": "1", "data-key": "learn" };
  return element(
    "p",
    {},
    element(
      "button",
      { type: "button", class: isNext && "primary", ...data, ...blocked(busy ? LEARNING_SENTENCE : "") },
      icon("learn"),
      text,
    ),
  );
}

/** Order that the chosen task is learned. @param {State} state */
export const learn = ({ task }) => post(resourcePath("tasks", task, "jobs"), { kind: "learn" });
