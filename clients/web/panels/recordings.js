// The recordings that run and the trackers that are there; what the station has to say.
import { post, resourcePath } from "../api.js";
import { taskTitle } from "../display_names.js";
import { closestData, element, hint } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny } from "../store.js";
import { capitalize, formatNumber, pluralize } from "../texts.js";

/** @type {Record<string, string>} */
const STATE_LABELS = { pausing: "will pause after this one", paused: "paused", lost: "the tracker has gone" };

/** @type {Record<string, string>} */
const PHASE_LABELS = {
  reach: "reaching for the object",
  grasp: "grasping it",
  transport: "carrying it",
  release: "letting go",
  return: "going back",
};
const SERVICE_AWAY_SENTENCE = "Not known: the service does not answer. What was recorded until then is kept.";
const NO_RECORDING_SENTENCE =
  "No tracker is here. Start one beside the hand, and it appears within a second; or show the task with the mouse, above.";

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function recordingList(place, { store, attempt }) {
  place.addEventListener("click", (event) => {
    const { verb, tracker, task, look } = closestData(event);
    if (look) store.set({ task: look });
    if (verb) attempt(() => post(resourcePath("tasks", task || store.state.task, "recording", verb), { tracker }));
  });
  return {
    update(state, changed) {
      if (!changesAny(changed, "recordings", "trackers", "station", "task", "tasks", "connection")) return;
      patchChildren(place, content(state));
    },
  };
}

/** @param {State} state @returns {Child} */
function content({ connection, recordings, trackers, station, task, tasks }) {
  if (connection === "lost") return hint(SERVICE_AWAY_SENTENCE);
  const idle = trackers.filter(({ name }) => !recordings.some(({ tracker }) => tracker === name));
  const rows = [
    ...recordings.map((recording) => recordingRow(recording, task, taskTitle(tasks, recording.task))),
    ...idle.map(({ name }) =>
      element("p", { class: "job" }, element("span", { class: "dot there" }), `${name} is here`),
    ),
    ...(station?.notes ?? []).map((note) => element("p", { class: "job note" }, capitalize(note))),
  ];
  return rows.length ? rows : hint(NO_RECORDING_SENTENCE);
}

/** @param {ActiveRecording} recording @param {string} task that is chosen @param {string} title of the task that is recorded */
function recordingRow(recording, task, title) {
  const { state, tracker, received, lost } = recording;
  const isHere = recording.task === task;
  const activity = STATE_LABELS[state] ?? PHASE_LABELS[recording.phase] ?? "waiting";
  const verb = state === "paused" || state === "pausing" ? "resume" : "pause";
  const order = { "data-verb": verb, "data-tracker": tracker, "data-task": recording.task };
  const look = { "data-look": recording.task, "data-key": `look ${tracker}` };
  const samples = `${formatNumber(received, 0)} ${pluralize(received, "sample")}, ${formatNumber(lost, 0)} lost`;
  return element(
    "div",
    { class: "job", "data-key": tracker },
    element(
      "p",
      {},
      element("span", { class: `dot ${state || "recording"}` }),
      `Recording ${tracker}${isHere ? "" : ` for ${title}`}: ${activity}`,
      element("span", { class: "note" }, samples),
    ),
    element(
      "span",
      { class: "buttons" },
      !isHere && element("button", { type: "button", ...look }, "Look at it"),
      state !== "lost" &&
        element("button", { type: "button", ...order, "data-key": `${verb} ${tracker}` }, capitalize(verb)),
    ),
  );
}
