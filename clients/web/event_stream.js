// Keeps the store up to date: hears of changes over the events' WebSocket and reads what has changed.
import { get, resourcePath } from "./api.js";
import { ListReader, TASK_LISTS } from "./lists.js";
import { ReconnectingSocket } from "./reconnecting_socket.js";
import { changesAny } from "./store.js";

const TASK_KEY = "task"; // the key that keeps the choice while the page is reloaded
const PATH_KEY = "path/"; // likewise, and the name of the task
const POLL_INTERVAL = 3000; // [ms] how often to ask while there is no WebSocket

/** @typedef {import("./lists.js").ListName} ListName */

/**
 * The list whose entry has changed when one of a topic has.
 * @type {Record<string, ListName>}
 */
const LIST_OF_TOPIC = {
  tasks: "tasks",
  demonstrations: "demonstrations",
  runs: "runs",
  paths: "runs", // edited since they were learned
  jobs: "jobs",
  executions: "executions",
};

/** @typedef {{topic: string, id: string, reason?: string, now?: object | null}} ServiceEvent as api/events.py describes it */

/** @typedef {Record<string, any>} TopicState the documents of a topic by their id */

/**
 * What the state holds of the topics that tell their state.
 * @type {Record<string, (documents: TopicState) => Partial<State>>}
 */
const STATE_OF_TOPIC = {
  station: (documents) => ({ station: documents[""] ?? null }),
  executor: (documents) => ({ executor: documents[""] ?? null }),
  trackers: (documents) => ({
    trackers: Object.keys(documents)
      .sort()
      .map((name) => ({ name, ...documents[name] })),
  }),
  recordings: (documents) => ({ recordings: Object.values(documents) }),
  guidance: (documents) => ({
    guidance: Object.fromEntries(Object.entries(documents).map(([task, { sentence }]) => [task, sentence])),
  }),
};

export class EventStream {
  /** @type {Record<string, TopicState>} */
  #topicStates = {};
  /** @type {Map<string, ((event: ServiceEvent) => void)[]>} */
  #listeners = new Map();
  /** @type {ConnectionState} */
  #connection = "connecting"; // of the events alone

  /** @param {import("./store.js").Store} store */
  constructor(store) {
    this.store = store;
    this.lists = new ListReader(store, (name, list, task) => this.#showList(name, list, task));
    store.subscribe((state, changed) => {
      if (changed.has("run")) this.#turnToRun(state);
      if (changesAny(changed, "runs", "selectedRun")) this.#readLatestVersions(state);
      if (changed.has("task")) this.#turnToTask(state.task);
      else if (changed.has("path") && state.path) sessionStorage.setItem(PATH_KEY + state.task, state.path);
    });
  }

  /**
   * Hear the events.
   * @param {(state: ConnectionState, details: ConnectionDetails) => void} onConnection
   */
  start(onConnection) {
    const socket = new ReconnectingSocket("events", {
      onMessage: (text) => this.#handleEvent(JSON.parse(text)),
      onState: (state, details) => {
        this.#connection = state;
        onConnection(state, details);
      },
    });
    socket.open();
    setInterval(() => {
      if (this.#connection !== "live" && !document.hidden) this.readAll();
    }, POLL_INTERVAL);
  }

  /**
   * Call `listener` with every event of a topic.
   * @param {string} topic
   * @param {(event: ServiceEvent) => void} listener
   */
  on(topic, listener) {
    this.#listeners.set(topic, [...(this.#listeners.get(topic) ?? []), listener]);
  }

  readAll() {
    this.read("tasks", "executions", ...TASK_LISTS);
  }

  /**
   * Read lists anew, as `ListReader.read`.
   * @param {...ListName} names
   */
  read(...names) {
    return this.lists.read(...names);
  }

  /**
   * @param {ListName} name
   * @param {any[]} list
   * @param {string} task that was chosen when it was asked for
   */
  async #showList(name, list, task) {
    if (name === "runs") {
      const selectedRun = await this.#readSelectedRun(list, task);
      if (task === this.store.state.task) this.store.set({ runs: list, selectedRun });
      return;
    }
    this.store.set({ [name]: list });
    if (name === "tasks" && task === this.store.state.task) this.#selectTask(list); // one chosen meanwhile may be newer
  }

  /** @param {State} state in which another run was chosen; the former one is shown until that is here */
  async #turnToRun({ task, runs }) {
    const selectedRun = runs && (await this.#readSelectedRun(runs, task));
    if (runs && task === this.store.state.task) this.store.set({ selectedRun });
  }

  /**
   * Read the run that is chosen, else the newest; null when there is none, or it cannot be read.
   * @param {RunSummary[]} runs
   * @param {string} task
   * @returns {Promise<Run | null>}
   */
  async #readSelectedRun(runs, task) {
    const { run: chosen, selectedRun } = this.store.state;
    const id = (runs.find((run) => run.id === chosen) ?? runs[0])?.id;
    if (!id || id === selectedRun?.id) return id ? selectedRun : null;
    const read = await get(resourcePath("tasks", task, "runs", id)).catch(() => null);
    return chosen === this.store.state.run ? read : this.#readSelectedRun(runs, task);
  }

  /**
   * Paths may have been edited since they were learned. An answer that is older than what is known, or none, changes
   * nothing.
   * @param {State} state
   */
  async #readLatestVersions(state) {
    const paths = state.selectedRun?.learned.paths ?? [];
    /** @type {LearnedPath[]} */
    const read = await Promise.all(paths.map((path) => get(resourcePath("paths", path.id)).catch(() => path)));
    const { latestVersions } = this.store.state;
    const newer = read.filter((path) => path.version >= (latestVersions[path.id]?.version ?? 0));
    this.store.set({
      latestVersions: { ...latestVersions, ...Object.fromEntries(newer.map((path) => [path.id, path])) },
    });
  }

  /** @param {string} task */
  #turnToTask(task) {
    sessionStorage.setItem(TASK_KEY, task);
    const nothing = { demonstrations: null, runs: null, jobs: null, selectedRun: null, latestVersions: {} };
    this.store.set({ ...nothing, run: "", path: sessionStorage.getItem(PATH_KEY + task) ?? "", focus: null });
    this.read(...TASK_LISTS);
  }

  /**
   * A task that is gone, or none, gives way to the one that was chosen in this browser tab, else to the newest.
   * @param {Task[]} tasks
   */
  #selectTask(tasks) {
    const names = tasks.map((task) => task.name);
    if (names.includes(this.store.state.task)) return;
    const kept = sessionStorage.getItem(TASK_KEY);
    this.store.set({ task: kept && names.includes(kept) ? kept : (names.at(-1) ?? "") });
  }

  /** @param {ServiceEvent} event */
  #handleEvent(event) {
    if (event.topic === "all") {
      if (event.reason === "connected") {
        this.#topicStates = {}; // the states follow
        for (const topic of Object.keys(STATE_OF_TOPIC)) this.#publishTopic(topic);
      }
      this.readAll();
    } else if ("now" in event) {
      const documents = { ...this.#topicStates[event.topic], [event.id]: event.now };
      if (event.now === null) delete documents[event.id];
      this.#topicStates[event.topic] = documents;
      this.#publishTopic(event.topic);
    } else {
      const list = LIST_OF_TOPIC[event.topic];
      if (list) this.lists.readEntry(list, event.id);
    }
    for (const listener of this.#listeners.get(event.topic) ?? []) listener(event);
  }

  /** @param {string} topic */
  #publishTopic(topic) {
    const changes = STATE_OF_TOPIC[topic]?.(this.#topicStates[topic] ?? {});
    if (changes) this.store.set(changes);
  }
}
