// The log of what has happened since the page was opened, newest first, whoever did it.
import { capitalize, element, hint, patchChildren, pluralize } from "./elements.js";
import { STATE_LABELS } from "./panels/arm_controls.js";
import { JOB_LABELS } from "./panels/jobs.js";

const MAX_ENTRIES = 100;
const JOB_OUTCOMES = { succeeded: "succeeded", failed: "failed", cancelled: "was cancelled" };

// `place` is a popover that `button` opens.
export function eventLog(place, button, store) {
  const list = element("ol", { class: "events", "aria-label": "events, newest first" });
  place.append(element("h2", {}, "What has happened"), list);
  let before = store.state;
  let unseen = 0;
  let entries = [];
  let away = false;
  // Between lost and live it connects, perhaps several times.
  const link = ({ connection }) => {
    if (connection !== (away ? "live" : "lost")) return [];
    away = !away;
    return [away ? "The service does not answer any more" : "The service answers again"];
  };
  const paint = () => {
    const nothing = element(
      "li",
      {},
      hint("Nothing since this page was opened. Recordings, learning, plans and what the arm does are noted here."),
    );
    patchChildren(list, entries.length ? entries.map(entryRow) : nothing);
    patchChildren(button, unseen ? `Events (${unseen})` : "Events");
  };
  store.subscribe((state) => {
    const texts = [...link(state), ...changesBetween(before, state)];
    before = state;
    if (!texts.length) return;
    const at = new Date().toLocaleTimeString("en-GB");
    entries = [...texts.reverse().map((text) => ({ at, text })), ...entries].slice(0, MAX_ENTRIES);
    unseen = place.matches(":popover-open") ? 0 : Math.min(MAX_ENTRIES, unseen + texts.length);
    paint();
  });
  place.addEventListener("toggle", () => {
    unseen = 0;
    paint();
  });
  paint();
}

const entryRow = ({ at, text }) => element("li", {}, element("time", {}, at), element("span", {}, text));

// Sentences about how two states differ, in the order of the work.
function changesBetween(before, now) {
  const same = before.task === now.task;
  return [
    ...pairWithPrevious(before, now, "tasks", "name").map(([old, task]) => !old && `Task ${task.name} was made`),
    ...membershipChanges(before.trackers, now.trackers, "name").map(
      ([name, here]) => `Tracker ${name} ${here ? "is here" : "has left"}`,
    ),
    ...membershipChanges(before.recordings, now.recordings, "tracker").map(
      ([name, here]) => `Recording from ${name} ${here ? "began" : "ended"}`,
    ),
    ...(same ? taskChanges(before, now) : []),
    ...armChanges(before.executor ?? {}, now.executor ?? {}),
    ...(now.station?.notes ?? []).map((note) => !before.station?.notes.includes(note) && capitalize(note)),
  ].filter(Boolean);
}

function taskChanges(before, now) {
  const ways = ({ learned: { clusters, demonstrations } }) =>
    `${clusters.length} ${pluralize(clusters.length, "way")} from ${demonstrations.length} ${pluralize(demonstrations.length, "demonstration")}`;
  return [
    ...pairWithPrevious(before, now, "demonstrations").map(([old, one]) => demonstrationChange(old, one)),
    ...pairWithPrevious(before, now, "runs").map(([old, run]) => !old && `Learned: ${ways(run)}`),
    ...pairWithPrevious(before, now, "jobs").map(([old, job]) => old?.state !== job.state && jobChange(job)),
  ];
}

function demonstrationChange(old, one) {
  const why = one.reasons?.length ? `, ${one.reasons.join("; ")}` : "";
  if (!old || old.verdict !== one.verdict)
    return `Demonstration ${one.number} ${old ? "was judged again" : "was recorded"}: ${one.verdict}${why}`;
  if (Boolean(old.discarded_ns) === Boolean(one.discarded_ns)) return "";
  return `Demonstration ${one.number} was ${one.discarded_ns ? "discarded" : "restored"}`;
}

function jobChange({ kind, state, message }) {
  const name = JOB_LABELS[kind] ?? capitalize(kind);
  return `${name} ${JOB_OUTCOMES[state] ?? "began"}${state === "failed" ? `: ${message}` : ""}`;
}

function armChanges(old, status) {
  const { operator, asking, state, reason } = status;
  return [
    operator !== old.operator &&
      (operator ? `${operator} has control of the arm` : old.operator && `${old.operator} gave control back`),
    asking && asking !== old.asking && `${asking} asks for control of the arm`,
    old.state &&
      state &&
      state !== old.state &&
      `Arm: ${(STATE_LABELS[state] ?? state).toLowerCase()}${reason ? `, ${reason}` : ""}`,
  ];
}

// [[former, present]] of a list that had been read before, so that a first reading is no news.
function pairWithPrevious(before, now, name, key = "id") {
  if (before[name] === now[name] || !before[name] || !now[name]) return [];
  const former = new Map(before[name].map((one) => [one[key], one]));
  return now[name].map((one) => [former.get(one[key]), one]);
}

// [[name, whether it is here]] of what has come and gone.
function membershipChanges(before, now, key) {
  if (before === now) return [];
  const [old, fresh] = [before, now].map((list) => list.map((one) => one[key]));
  return [
    ...fresh.filter((name) => !old.includes(name)).map((name) => [name, true]),
    ...old.filter((name) => !fresh.includes(name)).map((name) => [name, false]),
  ];
}
