// How an execution stands, in words and figures.
import { definitionList, element, progressBar } from "../elements.js";
import { capitalize, formatNumber, formatPercent } from "../texts.js";

/** @type {Record<string, string>} */
export const STATE_LABELS = {
  idle: "At rest",
  starting: "Starting",
  approaching: "On the way to the path",
  following: "On the path",
  held: "Held on the path",
  stopping: "Coming to rest",
  ended: "Ended",
  faulted: "Given up",
};

/** @param {ExecutorStatus} status */
export const isTeleoperated = ({ hand }) => Boolean(hand);

/**
 * @param {ExecutorStatus | undefined} status of the execution that runs, else of the last one
 * @param {boolean} isAway the service does not answer
 * @returns {Child}
 */
export function armState(status, isAway) {
  if (isAway) return stateLine("Not known: the service does not answer. On a lost link the arm holds.");
  if (!status) return stateLine(element("span", { class: "dot idle" }), "At rest. Nothing has been executed yet.");
  const reason = status.reason && element("span", { class: "reason" }, `: ${status.reason}`);
  return stateLine(element("span", { class: `dot ${status.state}` }), stateText(status), reason);
}

/**
 * How far it has come, and the figures of its motion, folded.
 * @param {ExecutorStatus} status
 * @param {boolean} isRunning
 * @returns {Child[]}
 */
export function armFigures(status, isRunning) {
  return [
    progressBar(status.progress, "progress along the path", !isRunning),
    element("details", {}, element("summary", {}, "Figures"), definitionList(figures(status, isRunning))),
  ];
}

/** The one part that a screen reader says when it changes: the figures change all the time. @param {...Child} children */
const stateLine = (...children) => element("p", { class: "state", role: "status" }, children);

/**
 * What is held need not be on the path yet.
 * @param {ExecutorStatus} status
 */
export function stateText(status) {
  const { state, activity } = status;
  if (state === "held" && activity) return activity.startsWith("on ") ? `Held ${activity}` : `Held while ${activity}`;
  if (state === "following" && isTeleoperated(status)) return "Following a live hand";
  return STATE_LABELS[state] ?? capitalize(state);
}

/** @param {ExecutorStatus} status @param {boolean} isRunning @returns {Fact[]} */
function figures({ override, duration, tracking_error, limit_use, cycles, late, missed }, isRunning) {
  const setpoints = () => `${formatNumber(late, 0)}, ${formatNumber(missed, 0)} of ${formatNumber(cycles, 0)}`;
  return [
    ["Speed", formatPercent(override)],
    [isRunning ? "Time so far" : "Time taken", duration > 0 && formatNumber(duration, 1, "s")],
    ["Largest tracking error", tracking_error > 0 && formatNumber(tracking_error * 1000, 2, "mrad")],
    ["Largest limit use", limit_use > 0 && formatPercent(limit_use)],
    ["Setpoints late, missed", cycles > 0 && setpoints()],
  ];
}
