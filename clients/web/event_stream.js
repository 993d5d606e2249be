// Keeps the store up to date: hears of changes over the events' WebSocket and reads what has changed.
import { get, resourcePath } from "./api.js";
import { ReconnectingSocket } from "./reconnecting_socket.js";
import { selectedRun } from "./store.js";

const TASK_KEY = "task"; // the key that keeps the choice while the page is reloaded
const POLL_INTERVAL = 3000; // [ms] how often to ask while there is no WebSocket

// What is read anew when a resource of a topic has changed.
const RESOURCES_BY_TOPIC = {
  tasks: ["tasks"],
  demonstrations: ["demonstrations"],
  runs: ["runs"],
  paths: ["runs"],
  plans: ["jobs"],
  jobs: ["jobs"],
  executions: ["executions"],
};
const STATE_TOPICS = ["station", "executor", "trackers", "recordings", "guidance"];
const TASK_RESOURCES = ["demonstrations", "runs", "jobs"];

export class EventStream {
  #topicStates = {}; // topic -> {id: state}
  #pending = new Set();
  #reading = null; // the rounds under way
  #listeners = new Map();

  constructor(store) {
    this.store = store;
    this.connection = "connecting"; // of the events alone
  }

  // `onConnection(state, details)` as ReconnectingSocket's onState.
  start(onConnection) {
    const socket = new ReconnectingSocket("events", {
      onMessage: (text) => this.#handleEvent(JSON.parse(text)),
      onState: (state, details) => {
        this.connection = state;
        onConnection(state, details);
      },
    });
    socket.open();
    setInterval(() => {
      if (this.connection !== "live" && !document.hidden) this.readAll();
    }, POLL_INTERVAL);
    this.store.subscribe((state, changed) => {
      if (changed.has("runs") || changed.has("run")) this.#readLatestVersions(state);
      if (!changed.has("task")) return;
      sessionStorage.setItem(TASK_KEY, state.task);
      this.store.set({
        demonstrations: null,
        runs: null,
        jobs: null,
        latestVersions: {},
        run: "",
        path: "",
        focus: null,
      });
      this.read(...TASK_RESOURCES);
    });
  }

  // Call `listener(event)` with every event of a topic.
  on(topic, listener) {
    this.#listeners.set(topic, [...(this.#listeners.get(topic) ?? []), listener]);
  }

  readAll() {
    this.read("tasks", "executions", ...TASK_RESOURCES);
  }

  // Read lists anew; what is asked for meanwhile is read in the next round. Resolves when they have been read.
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

  async #readOne(name) {
    const { task } = this.store.state;
    if (TASK_RESOURCES.includes(name) && !task) return;
    try {
      const list = await get(TASK_RESOURCES.includes(name) ? resourcePath("tasks", task, name) : name);
      if (task === this.store.state.task || !TASK_RESOURCES.includes(name)) this.store.set({ [name]: list });
      if (name === "tasks" && task === this.store.state.task) this.#selectTask(list); // a task that was chosen meanwhile may be newer than the list
    } catch {
      // the connection's state says so already, and it is read again when it is back
    }
  }

  // Paths may have been edited since they were learned. An answer that is older than what is known, or none, changes nothing.
  async #readLatestVersions(state) {
    const paths = selectedRun(state)?.learned.paths ?? [];
    const read = await Promise.all(paths.map((path) => get(resourcePath("paths", path.id)).catch(() => path)));
    const { latestVersions } = this.store.state;
    const newer = read.filter((path) => path.version >= (latestVersions[path.id]?.version ?? 0));
    this.store.set({
      latestVersions: { ...latestVersions, ...Object.fromEntries(newer.map((path) => [path.id, path])) },
    });
  }

  // A task that is gone, or none, gives way to the one that was chosen in this browser tab, else to the newest.
  #selectTask(tasks) {
    const names = tasks.map((task) => task.name);
    if (names.includes(this.store.state.task)) return;
    const kept = sessionStorage.getItem(TASK_KEY);
    this.store.set({ task: names.includes(kept) ? kept : (names.at(-1) ?? "") });
  }

  #handleEvent(event) {
    if (event.topic === "all") {
      if (event.reason === "connected") {
        this.#topicStates = {}; // the states follow
        for (const topic of STATE_TOPICS) this.#publishTopic(topic);
      }
      this.readAll();
    } else if ("now" in event) {
      const things = { ...this.#topicStates[event.topic], [event.id]: event.now };
      if (event.now === null) delete things[event.id];
      this.#topicStates[event.topic] = things;
      this.#publishTopic(event.topic);
    } else {
      this.read(...(RESOURCES_BY_TOPIC[event.topic] ?? []));
    }
    for (const listener of this.#listeners.get(event.topic) ?? []) listener(event);
  }

  #publishTopic(topic) {
    const things = this.#topicStates[topic] ?? {};
    const now = {
      station: () => things[""] ?? null,
      executor: () => things[""] ?? null,
      trackers: () =>
        Object.entries(things)
          .map(([name, tracker]) => ({ name, ...tracker }))
          .sort((a, b) => a.name.localeCompare(b.name)),
      recordings: () => Object.values(things),
      guidance: () => Object.fromEntries(Object.entries(things).map(([task, { sentence }]) => [task, sentence])),
    }[topic];
    if (now) this.store.set({ [topic]: now() });
  }
}
