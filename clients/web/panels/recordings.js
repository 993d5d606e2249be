// The recordings that run and the trackers that are there; the guidance; what the station has to say.
import { post, resourcePath } from "../api.js";
import { capitalize, element, formatNumber, hint, patchChildren, pluralize } from "../elements.js";

const PHASE_LABELS = {
  reach: "reaching for the object",
  grasp: "grasping it",
  transport: "carrying it",
  release: "letting go",
  return: "going back",
};

export function recordingList(place, { store, attempt }) {
  place.addEventListener("click", (event) => {
    const { verb, tracker, task, look } = event.target.closest("button")?.dataset ?? {};
    if (look) store.set({ task: look });
    if (verb) attempt(() => post(`${resourcePath("tasks", task || store.state.task, "recording", verb)}`, { tracker }));
  });
  return {
    update(state, changed) {
      if (!["recordings", "trackers", "station", "guidance", "task", "connection"].some((name) => changed.has(name)))
        return;
      if (state.connection === "lost") {
        patchChildren(place, hint("Not known: the service does not answer. What was recorded until then is kept."));
        return;
      }
      const idle = state.trackers.filter((tracker) => !state.recordings.some((r) => r.tracker === tracker.name));
      const lines = [
        ...state.recordings.map((recording) => recordingRow(recording, state.task)),
        ...idle.map((tracker) =>
          element("p", { class: "job" }, element("span", { class: "dot there" }), `${tracker.name} is here`),
        ),
        ...(state.station?.notes ?? []).map((note) => element("p", { class: "job note" }, capitalize(note))),
      ];
      patchChildren(
        place,
        lines.length
          ? lines
          : hint(
              "No tracker is here. Start one beside the hand, and it appears within a second; or show the task with the mouse, above.",
            ),
      );
    },
  };
}

function recordingRow(recording, task) {
  const { state, tracker, received, lost } = recording;
  const paused = state === "paused" || state === "pausing";
  const doing =
    { pausing: "will pause after this one", paused: "paused", lost: "the tracker has gone" }[state] ??
    PHASE_LABELS[recording.phase] ??
    "waiting";
  const key = (verb) => ({
    type: "button",
    "data-verb": verb,
    "data-tracker": tracker,
    "data-task": recording.task,
    "data-key": `${verb} ${tracker}`,
  });
  return element(
    "div",
    { class: "job", "data-key": tracker },
    element(
      "p",
      {},
      element("span", { class: `dot ${state || "recording"}` }),
      `Recording ${tracker}${recording.task === task ? "" : ` for ${recording.task}`}: ${doing}`,
      element(
        "span",
        { class: "note" },
        `${formatNumber(received, 0)} ${pluralize(received, "sample")}, ${formatNumber(lost, 0)} lost`,
      ),
    ),
    element(
      "span",
      { class: "buttons" },
      recording.task !== task &&
        element("button", { type: "button", "data-look": recording.task, "data-key": `look ${tracker}` }, "Look at it"),
      state !== "lost" && element("button", key(paused ? "resume" : "pause"), paused ? "Resume" : "Pause"),
    ),
  );
}
