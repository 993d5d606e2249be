// Keeps the store up to date: hears of changes over the events' WebSocket and reads what has changed.
import { get, resourcePath } from "./api.js";
import { ReconnectingSocket } from "./reconnecting_socket.js";
import { changesAny, selectedRun } from "./store.js";

const TASK_KEY = "task"; // the key that keeps the choice while the page is reloaded
const POLL_INTERVAL = 3000; // [ms] how often to ask while there is no WebSocket

/** @typedef {"tasks" | "executions" | "demonstrations" | "runs" | "jobs"} Resource a list of the state */

/**
 * What is read anew when a resource of a topic has changed.
 * @type {Record<string, Resource[]>}
 */
const RESOURCES_BY_TOPIC = {
  tasks: ["tasks"],
  demonstrations: ["demonstrations"],
  runs: ["runs"],
  paths: ["runs"],
  plans: ["jobs"],
  jobs: ["jobs"],
  executions: ["executions"],
};

/** @type {Resource[]} */
const TASK_RESOURCES = ["demonstrations", "runs", "jobs"];

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
  /** @type {Set<Resource>} */
  #pending = new Set();
  /** @type {Promise<void> | null} */
  #reading = null; // the rounds under way
  /** @type {Map<string, ((event: ServiceEvent) => void)[]>} */
  #listeners = new Map();
  /** @type {ConnectionState} */
  #connection = "connecting"; // of the events alone

  /** @param {import("./store.js").Store} store */
  constructor(store) {
    this.store = store;
    store.subscribe((state, changed) => {
      if (changesAny(changed, "runs", "run")) this.#readLatestVersions(state);
      if (changed.has("task")) this.#turnToTask(state.task);
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
    this.read("tasks", "executions", ...TASK_RESOURCES);
  }

  /**
   * Read lists anew; what is asked for meanwhile is read in the next round. Resolves when they have been read.
   * @param {...Resource} names
   */
  read(...names) {
    for (const name of names) this.#pending.add(name);
    if (this.#pending.size) this.#reading ??= this.#readRounds();
    return this.#reading;
  }

  async #readRounds() {
    while (this.#pending.size) {
      const round = [...this.#pending];
      this.#pending.clear();
      await Promise.all(round.map((name) => this.#readOne(name)));
    }
    this.#reading = null;
  }

  /** @param {Resource} name */
  async #readOne(name) {
    const { task } = this.store.state;
    const isOfTask = TASK_RESOURCES.includes(name);
    if (isOfTask && !task) return;
    try {
      const list = await get(isOfTask ? resourcePath("tasks", task, name) : name);
      const isSameTask = task === this.store.state.task;
      if (isSameTask || !isOfTask) this.store.set({ [name]: list });
      if (name === "tasks" && isSameTask) this.#selectTask(list); // one that was chosen meanwhile may be newer than the list
    } catch {
      // the connection's state says so already, and it is read again when it is back
    }
  }

  /**
   * Paths may have been edited since they were learned. An answer that is older than what is known, or none, changes
   * nothing.
   * @param {State} state
   */
  async #readLatestVersions(state) {
    const paths = selectedRun(state)?.learned.paths ?? [];
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
    const nothing = { demonstrations: null, runs: null, jobs: null, latestVersions: {} };
    this.store.set({ ...nothing, run: "", path: "", focus: null });
    this.read(...TASK_RESOURCES);
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
      this.read(...(RESOURCES_BY_TOPIC[event.topic] ?? []));
    }
    for (const listener of this.#listeners.get(event.topic) ?? []) listener(event);
  }

  /** @param {string} topic */
  #publishTopic(topic) {
    const changes = STATE_OF_TOPIC[topic]?.(this.#topicStates[topic] ?? {});
    if (changes) this.store.set(changes);
  }
}
