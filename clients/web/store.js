// The one state of the page: set() merges, subscribers hear once a frame of what has changed.
//
// connection   "connecting" | "live" | "lost"                 tasks          [task], oldest first
// task         name of the chosen task, "" = none             demonstrations [demonstration] of the task
// runs         [run] of the task, newest first                jobs           [job] of the task, oldest first
// executions   [execution], newest first                      recordings     [report] of running recordings
// trackers     [{name, announced}]                            guidance       {task: sentence}
// station      {version, notes} or null                       executor       status or null when it is silent
// run          id of the selected run, "" = the newest
// plan         certified plan of the selected path, or null
// path         id of the selected learned path                focus          {kind, id} under the pointer, or null;
//                                                                     kind is demonstrations or paths
// trajectoriesLoaded   how many trajectories of demonstrations have been read
// latestVersions       {path id: its newest version}, of the run
// pathSummaries        {path id: duration, clearance, reach ..., see panels/path_summaries.js}
// Lists are null until they have been read, and stay as they were while the service is away.
export const INITIAL_STATE = Object.freeze({
  connection: "connecting",
  tasks: null,
  task: "",
  demonstrations: null,
  runs: null,
  jobs: null,
  executions: null,
  recordings: [],
  trackers: [],
  guidance: {},
  station: null,
  executor: null,
  run: "",
  path: "",
  plan: null,
  focus: null,
  trajectoriesLoaded: 0,
  latestVersions: {},
  pathSummaries: {},
});

const RESTING_STATES = ["idle", "ended", "faulted"];

export class Store {
  #changed = new Set();
  #subscribers = new Set();

  constructor() {
    this.state = INITIAL_STATE;
  }

  // Merge `changes`; subscribers are called before the next frame is drawn, once for all changes.
  set(changes) {
    const changedNames = Object.keys(changes).filter((name) => changes[name] !== this.state[name]);
    if (!changedNames.length) return;
    this.state = Object.freeze({ ...this.state, ...changes });
    if (!this.#changed.size) queueMicrotask(() => this.#notify());
    for (const name of changedNames) this.#changed.add(name);
  }

  // `listener(state, changed)`: changed is the Set of the names that differ. Returns what ends that.
  subscribe(listener) {
    this.#subscribers.add(listener);
    return () => this.#subscribers.delete(listener);
  }

  #notify() {
    const changed = new Set(this.#changed);
    this.#changed.clear();
    for (const listener of this.#subscribers) listener(this.state, changed);
  }
}

// Questions that several panels ask of the state.

// The selected run: the chosen one, else the newest; null while there is none.
export const selectedRun = (state) => state.runs?.find((run) => run.id === state.run) ?? state.runs?.[0] ?? null;

// The learned paths of the selected run, each in its newest version.
export const latestPaths = (state) =>
  (selectedRun(state)?.learned.paths ?? []).map((path) => state.latestVersions[path.id] ?? path);

// The selected learned path: the chosen one, else the first of the run; null while there is none.
export function selectedPath(state) {
  const paths = latestPaths(state);
  return paths.find((path) => path.id === state.path) ?? paths[0] ?? null;
}

// The status of the execution that moves the arm now, or null.
export const activeExecution = (state) =>
  state.executor && !RESTING_STATES.includes(state.executor.state) ? state.executor : null;
