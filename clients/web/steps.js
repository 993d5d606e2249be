// The steps of the work, which are the page's tabs: which of them are done for the task and the way that are chosen.
import { selectedPath } from "./store.js";

/**
 * The tabs whose work is done: a demonstration is kept, ways are learned, the way is certified, its motion was run to its end.
 * @param {State} state
 * @returns {Set<string>}
 */
export function doneSteps(state) {
  const { demonstrations, plan, executions } = state;
  const path = selectedPath(state);
  /** @param {Execution} execution */
  const isRun = ({ plan: run, status }) => run === plan?.id && status.state === "ended" && status.progress === 1;
  const done = {
    demonstrate: demonstrations?.some(({ verdict, discarded_ns }) => verdict !== "reject" && !discarded_ns),
    ways: path !== null,
    edit: path !== null && plan?.path === path.id && plan.path_version === path.version,
    run: plan && executions?.some(isRun),
  };
  return new Set(Object.entries(done).flatMap(([id, isDone]) => (isDone ? [id] : [])));
}
