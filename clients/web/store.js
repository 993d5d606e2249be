// The one state of the page: set() merges, subscribers hear once a frame of what has changed.
//
// connection   "connecting" | "live" | "lost"                 tasks          [task], oldest first
// task         name of the chosen task, "" = none             demonstrations [demonstration] of the task
// runs         [summary of a run] of the task, newest first   jobs           [job] of the task, newest first
// executions   [execution], newest first                      recordings     [report] of running recordings
// trackers     [{name, announced}]                            guidance       {task: sentence}
// station      {name, version, notes, ...} or null            executor       status or null when it is silent
// shownStation whose entries are shown, "" = all, null = this one (stations.js)
// run          id of the chosen run, "" = the newest          selectedRun    the run that is shown, null = none
// plan         certified plan of the selected path, or null    identity       who uses the page, and may do what
// path         id of the selected learned path                focus          {kind, id} under the pointer, or null;
//                                                                     kind is demonstrations or paths
// trajectoriesLoaded   how many trajectories of demonstrations have been read
// latestVersions       {path id: its newest version}, of the run
// pathSummaries        {path id: duration, clearance, reach ..., see panels/path_summaries.js}
// Lists are null until they have been read, and stay as they were while the service is away.
// Until the service has said who uses the page.
/** @type {Identity} */
const UNAUTHENTICATED_IDENTITY = {
  mode: "none",
  name: "",
  capabilities: ["view", "demonstrate", "teach", "operate", "administer"],
  provider: "",
  groups: [],
};

/** @type {State} */
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
  shownStation: null,
  executor: null,
  lease: null,
  identity: UNAUTHENTICATED_IDENTITY,
  selectedRun: null,
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
  /** @type {Changed} */
  #changed = new Set();
  /** @type {Set<(state: State, changed: Changed) => void>} */
  #subscribers = new Set();

  state = INITIAL_STATE;

  /**
   * Merge `changes`; subscribers are called before the next frame is drawn, once for all changes.
   * @param {Partial<State>} changes
   */
  set(changes) {
    const names = /** @type {(keyof State)[]} */ (Object.keys(changes));
    const changedNames = names.filter((name) => changes[name] !== this.state[name]);
    if (!changedNames.length) return;
    this.state = Object.freeze({ ...this.state, ...changes });
    if (!this.#changed.size) queueMicrotask(() => this.#notify());
    for (const name of changedNames) this.#changed.add(name);
  }

  /**
   * Call `listener` with the names that differ, after every change. Returns what ends that.
   * @param {(state: State, changed: Changed) => void} listener
   */
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

/**
 * Whether one of these names of the state has changed.
 * @param {Changed} changed
 * @param {...keyof State} names
 */
export const changesAny = (changed, ...names) => names.some((name) => changed.has(name));

/**
 * The learned paths of the selected run, each in its newest version.
 * @param {State} state
 */
export const latestPaths = (state) =>
  (state.selectedRun?.learned.paths ?? []).map((path) => state.latestVersions[path.id] ?? path);

/**
 * The selected learned path: the chosen one, else the first of the run; null while there is none.
 * @param {State} state
 */
export function selectedPath(state) {
  const paths = latestPaths(state);
  return paths.find((path) => path.id === state.path) ?? paths[0] ?? null;
}

/**
 * The status of the execution that moves the arm now, or null.
 * @param {State} state
 */
export const activeExecution = (state) =>
  state.executor && !RESTING_STATES.includes(state.executor.state) ? state.executor : null;

/**
 * The way that each demonstration of the selected run belongs to: id -> index of the cluster.
 * @param {State} state
 * @returns {Map<string, number>}
 */
export function waysOfDemonstrations(state) {
  const clusters = state.selectedRun?.learned.clusters ?? [];
  return new Map(clusters.flatMap(({ index, members }) => members.map((id) => [id, index])));
}

/**
 * The number of each demonstration by its id.
 * @param {State} state
 * @returns {Map<string, number>}
 */
export const demonstrationNumbers = (state) =>
  new Map((state.demonstrations ?? []).map(({ id, number }) => [id, number]));
