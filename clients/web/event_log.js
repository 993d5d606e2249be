// The log of what has happened since the page was opened, newest first, whoever did it.
import { element, hint } from "./elements.js";
import { STATE_LABELS } from "./panels/arm_state.js";
import { JOB_LABELS } from "./panels/jobs.js";
import { patchChildren } from "./patch_children.js";
import { capitalize, pluralize } from "./texts.js";

const MAX_ENTRIES = 100;

/** @type {Record<string, string>} */
const JOB_OUTCOMES = { succeeded: "succeeded", failed: "failed", cancelled: "was cancelled" };
const EMPTY_LOG_SENTENCE =
  "Nothing since this page was opened. Recordings, learning, plans and what the arm does are noted here.";

/**
 * @param {HTMLElement} place a popover that `button` opens
 * @param {HTMLElement} button
 * @param {import("./store.js").Store} store
 */
export function eventLog(place, button, store) {
  const list = element("ol", { class: "events", "aria-label": "events, newest first" });
  place.append(element("h2", {}, "What has happened"), list);
  let before = store.state;
  let unseen = 0;
  /** @type {{at: string, text: string}[]} */
  let entries = [];
  const connectionChanges = connectionWatcher();
  const render = () => {
    patchChildren(list, entries.length ? entries.map(entryRow) : element("li", {}, hint(EMPTY_LOG_SENTENCE)));
    patchChildren(button, unseen ? `Events (${unseen})` : "Events");
  };
  store.subscribe((state) => {
    const texts = [...connectionChanges(state), ...changesBetween(before, state)];
    before = state;
    if (!texts.length) return;
    const at = new Date().toLocaleTimeString("en-GB");
    entries = [...texts.reverse().map((text) => ({ at, text })), ...entries].slice(0, MAX_ENTRIES);
    unseen = place.matches(":popover-open") ? 0 : Math.min(MAX_ENTRIES, unseen + texts.length);
    render();
  });
  place.addEventListener("toggle", () => {
    unseen = 0;
    render();
  });
  render();
}

/** @param {{at: string, text: string}} entry */
const entryRow = ({ at, text }) => element("li", {}, element("time", {}, at), element("span", {}, text));

/** Returns what says that the service is away or back: between lost and live it connects, perhaps several times. */
function connectionWatcher() {
  let away = false;
  /** @param {State} state */
  return ({ connection }) => {
    if (connection !== (away ? "live" : "lost")) return [];
    away = !away;
    return [away ? "The service does not answer any more" : "The service answers again"];
  };
}

/**
 * Sentences about tasks that were made, renamed, deleted or brought back; whatever it is called, a task keeps when it was made.
 * @param {Task[] | null} before
 * @param {Task[] | null} now
 */
export function taskListChanges(before, now) {
  if (before === now || !before || !now) return [];
  const [former, present] = [before, now].map(
    (tasks) => new Map(tasks.map((task) => [task.created_ns, task.display_name || task.name])),
  );
  const newest = Math.max(0, ...former.keys());
  const come = [...present].flatMap(([made, name]) => {
    const old = former.get(made);
    if (old === name) return [];
    if (old) return [`Task ${old} is called ${name} now`];
    return [`Task ${name} ${made > newest ? "was made" : "was brought back"}`];
  });
  const gone = [...former].filter(([made]) => !present.has(made));
  return [...come, ...gone.map(([, name]) => `Task ${name} was deleted; it is kept`)];
}

/**
 * Sentences about how two states differ, in the order of the work.
 * @param {State} before
 * @param {State} now
 */
function changesBetween(before, now) {
  const notes = (now.station?.notes ?? []).filter((note) => !before.station?.notes.includes(note));
  return [
    ...taskListChanges(before.tasks, now.tasks),
    ...membershipChanges(before.trackers, now.trackers, ({ name }) => name).map(
      ([name, here]) => `Tracker ${name} ${here ? "is here" : "has left"}`,
    ),
    ...membershipChanges(before.recordings, now.recordings, ({ tracker }) => tracker).map(
      ([name, here]) => `Recording from ${name} ${here ? "began" : "ended"}`,
    ),
    ...(before.task === now.task ? taskChanges(before, now) : []),
    ...(before.executor && now.executor ? armChanges(before.executor, now.executor) : []),
    ...notes.map(capitalize),
  ].filter(Boolean);
}

/** @param {State} before @param {State} now */
function taskChanges(before, now) {
  return [
    ...pairWithPrevious(before.demonstrations, now.demonstrations, ({ id }) => id).map(demonstrationChange),
    ...newEntries(before.runs, now.runs, ({ id }) => id).map(([, run]) => runChange(run)),
    ...pairWithPrevious(before.jobs, now.jobs, ({ id }) => id).map(jobChange),
  ];
}

/** @param {[Demonstration | undefined, Demonstration]} pair */
function demonstrationChange([old, one]) {
  const why = one.reasons.length ? `, ${one.advice || one.reasons.join("; ")}` : "";
  if (!old || old.verdict !== one.verdict) {
    return `Demonstration ${one.number} ${old ? "was judged again" : "was recorded"}: ${one.verdict}${why}`;
  }
  if (Boolean(old.discarded_ns) === Boolean(one.discarded_ns)) return "";
  return `Demonstration ${one.number} was ${one.discarded_ns ? "discarded" : "restored"}`;
}

/** @param {RunSummary} run */
function runChange({ paths, demonstrations }) {
  const ways = `${paths.length} ${pluralize(paths.length, "way")}`;
  return `Learned: ${ways} from ${demonstrations} ${pluralize(demonstrations, "demonstration")}`;
}

/** @param {[Job | undefined, Job]} pair */
function jobChange([old, { kind, state, message }]) {
  if (old?.state === state) return "";
  const name = JOB_LABELS[kind] ?? capitalize(kind);
  return `${name} ${JOB_OUTCOMES[state] ?? "began"}${state === "failed" ? `: ${message}` : ""}`;
}

/** @param {ExecutorStatus} old @param {ExecutorStatus} status */
function armChanges(old, { operator, asking, state, reason }) {
  const sentences = [];
  if (operator && operator !== old.operator) sentences.push(`${operator} has control of the arm`);
  if (!operator && old.operator) sentences.push(`${old.operator} gave control back`);
  if (asking && asking !== old.asking) sentences.push(`${asking} asks for control of the arm`);
  const label = (STATE_LABELS[state] ?? state).toLowerCase();
  if (state !== old.state) sentences.push(`Arm: ${label}${reason ? `, ${reason}` : ""}`);
  return sentences;
}

/**
 * [former, present] of each entry of a list that had been read before, so that a first reading is no change.
 * @template T
 * @param {T[] | null} before
 * @param {T[] | null} now
 * @param {(entry: T) => string} keyOf
 * @returns {[T | undefined, T][]}
 */
function pairWithPrevious(before, now, keyOf) {
  if (before === now || !before || !now) return [];
  const former = new Map(before.map((entry) => [keyOf(entry), entry]));
  return now.map((entry) => [former.get(keyOf(entry)), entry]);
}

/**
 * The pairs of those entries that were not there before.
 * @template T
 * @param {T[] | null} before
 * @param {T[] | null} now
 * @param {(entry: T) => string} keyOf
 */
const newEntries = (before, now, keyOf) => pairWithPrevious(before, now, keyOf).filter(([old]) => !old);

/**
 * [name, whether it is here] of what has come and gone.
 * @template T
 * @param {T[]} before
 * @param {T[]} now
 * @param {(entry: T) => string} keyOf
 * @returns {[string, boolean][]}
 */
function membershipChanges(before, now, keyOf) {
  if (before === now) return [];
  const [old, fresh] = [before.map(keyOf), now.map(keyOf)];
  return [
    ...fresh.filter((name) => !old.includes(name)).map((name) => /** @type {[string, boolean]} */ ([name, true])),
    ...old.filter((name) => !fresh.includes(name)).map((name) => /** @type {[string, boolean]} */ ([name, false])),
  ];
}
