// The one state of the page: set() merges, subscribers hear once a frame of what has changed.
//
// connection   "connecting" | "live" | "lost"                 tasks          [task], oldest first
// task         name of the chosen task, "" = none             demonstrations [demonstration] of the task
// runs         [run] of the task, newest first                jobs           [job] of the task, oldest first
// executions   [execution], newest first                      recordings     [report] of running recordings
// trackers     [{name, announced}]                            guidance       {task: sentence}
// station      {version, notes} or null                       executor       status or null when it is silent
// run          id of the run that is looked at, "" = the newest
// plan         certified plan of the path that is looked at, or null
// path         id of the learned path that is looked at       focus          {kind, id} under the pointer, or null;
// courses      how many courses of demonstrations have come                  kind is demonstrations or paths
// newest       {path id: its newest version}, of the run
// prospects    {path: what lies before it, see panels/path_summaries.js}
// Lists are null until they have been read, and stay as they were while the service is away.
export const EMPTY = Object.freeze({
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
  courses: 0,
  newest: {},
  prospects: {},
});

const RESTING = ["idle", "ended", "faulted"];

export class Store {
  #changed = new Set();
  #subscribers = new Set();

  constructor() {
    this.state = EMPTY;
  }

  // Merge `changes`; subscribers are called before the next frame is drawn, once for all changes.
  set(changes) {
    const news = Object.keys(changes).filter((name) => changes[name] !== this.state[name]);
    if (!news.length) return;
    this.state = Object.freeze({ ...this.state, ...changes });
    if (!this.#changed.size) queueMicrotask(() => this.#tell());
    for (const name of news) this.#changed.add(name);
  }

  // `hear(state, changed)`: changed is the Set of the names that differ. Returns what ends it.
  subscribe(hear) {
    this.#subscribers.add(hear);
    return () => this.#subscribers.delete(hear);
  }

  #tell() {
    const changed = new Set(this.#changed);
    this.#changed.clear();
    for (const hear of this.#subscribers) hear(this.state, changed);
  }
}

// Questions that several panels ask of the state.

// The run that is looked at: the chosen one, else the newest; null while there is none.
export const runOf = (state) => state.runs?.find((run) => run.id === state.run) ?? state.runs?.[0] ?? null;

// The learned paths of the run that is looked at, each in its newest version.
export const pathsOf = (state) => (runOf(state)?.learned.paths ?? []).map((path) => state.newest[path.id] ?? path);

// The learned path that is looked at: the chosen one, else the first of the run; null while there is none.
export function pathOf(state) {
  const paths = pathsOf(state);
  return paths.find((path) => path.id === state.path) ?? paths[0] ?? null;
}

// The status of the execution that moves the arm now, or null.
export const moving = (state) => (state.executor && !RESTING.includes(state.executor.state) ? state.executor : null);
