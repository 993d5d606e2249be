// The recordings that run and the trackers that are there; what the coach thinks; what the station has to say.
import { at, post } from "../api.js";
import { element, hint, plural, replace, sentence } from "../elements.js";

export function recordings(place, { store, attempt }) {
  place.addEventListener("click", (event) => {
    const { verb, tracker, task } = event.target.closest("button[data-verb]")?.dataset ?? {};
    if (verb) attempt(() => post(`${at("tasks", task || store.state.task, "recording", verb)}`, { tracker }));
  });
  return {
    update(state, changed) {
      if (!["recordings", "trackers", "station", "coach", "task", "connection"].some((name) => changed.has(name))) return;
      const idle = state.trackers.filter((tracker) => !state.recordings.some((r) => r.tracker === tracker.name));
      const lines = [
        ...state.recordings.map((recording) => line(recording, state.task)),
        ...idle.map((tracker) => element("p", { class: "job" }, element("span", { class: "dot there" }), `${tracker.name} is here`)),
        ...(state.station?.notes ?? []).map((note) => element("p", { class: "job note" }, sentence(note))),
      ];
      replace(place, lines.length ? lines : hint("No tracker is here. Start one beside the hand, and it appears within a second."));
    },
  };
}

function line(recording, task) {
  const { state, tracker, received, lost } = recording;
  const paused = state === "paused" || state === "pausing";
  const doing = { recording: recording.phase, pausing: "will pause after this one", paused: "paused", lost: "the tracker has gone" }[state] ?? recording.phase;
  const key = (verb) => ({ type: "button", "data-verb": verb, "data-tracker": tracker, "data-task": recording.task, "data-key": `${verb} ${tracker}` });
  return element(
    "p",
    { class: "job" },
    element("span", { class: `dot ${state || "recording"}` }),
    `Recording ${tracker}${recording.task === task ? "" : ` for ${recording.task}`}: ${doing || "waiting"}, ${received} ${plural(received, "sample")}`,
    lost > 0 && `, ${lost} lost`,
    " ",
    state !== "lost" && element("button", key(paused ? "resume" : "pause"), paused ? "Resume" : "Pause"),
  );
}
