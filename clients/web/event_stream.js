// Keeps the store true: hears of changes over the events' WebSocket and reads what has changed.
import { at, get, socketAddress } from "./api.js";
import { runOf } from "./store.js";

const SHORTEST = 250; // [ms] first pause before connecting again
const LONGEST = 5000;
const CHOSEN = "task"; // the key that keeps the choice while the page is reloaded
const ASK = 3000; // [ms] how often to ask while there is no WebSocket

// What is read anew when a resource of a topic has changed.
const READ = { tasks: ["tasks"], demonstrations: ["demonstrations"], runs: ["runs"], paths: ["runs"], plans: ["jobs"], jobs: ["jobs"], executions: ["executions"] };
const STANDING = ["station", "executor", "trackers", "recordings", "guidance"];
const OF_TASK = ["demonstrations", "runs", "jobs"];

export class Feed {
  #standing = {}; // topic -> {id: how it stands}
  #waiting = new Set();
  #reading = null; // the rounds under way
  #pause = SHORTEST;
  #listeners = new Map();

  constructor(store) {
    this.store = store;
    this.connection = "connecting"; // of the events alone
  }

  start(connected) {
    this.#connect(connected);
    setInterval(() => {
      if (this.connection !== "live" && !document.hidden) this.readAll();
    }, ASK);
    this.store.subscribe((state, changed) => {
      if (changed.has("runs") || changed.has("run")) this.#readNewest(state);
      if (!changed.has("task")) return;
      sessionStorage.setItem(CHOSEN, state.task);
      this.store.set({ demonstrations: null, runs: null, jobs: null, newest: {}, run: "", path: "", focus: null });
      this.read(...OF_TASK);
    });
  }

  // Hear every piece of news of a topic as it comes: `hear(piece)`.
  on(topic, hear) {
    this.#listeners.set(topic, [...(this.#listeners.get(topic) ?? []), hear]);
  }

  readAll() {
    this.read("tasks", "executions", ...OF_TASK);
  }

  // Read lists anew; what is asked for meanwhile is read in the next round. Resolves when they have been read.
  read(...names) {
    for (const name of names) this.#waiting.add(name);
    if (this.#waiting.size) this.#reading ??= this.#readRounds();
    return this.#reading;
  }

  async #readRounds() {
    while (this.#waiting.size) {
      const round = [...this.#waiting];
      this.#waiting.clear();
      await Promise.all(round.map((name) => this.#readOne(name)));
    }
    this.#reading = null;
  }

  async #readOne(name) {
    const { task } = this.store.state;
    if (OF_TASK.includes(name) && !task) return;
    try {
      const list = await get(OF_TASK.includes(name) ? at("tasks", task, name) : name);
      if (task === this.store.state.task || !OF_TASK.includes(name)) this.store.set({ [name]: list });
      if (name === "tasks" && task === this.store.state.task) this.#choose(list); // a task that was chosen meanwhile may be newer than the list
    } catch {
      // the connection's state says so already, and it is read again when it is back
    }
  }

  // Paths may have been edited since they were learned. An answer that is older than what is known, or none, changes nothing.
  async #readNewest(state) {
    const paths = runOf(state)?.learned.paths ?? [];
    const read = await Promise.all(paths.map((path) => get(at("paths", path.id)).catch(() => path)));
    const { newest } = this.store.state;
    const newer = read.filter((path) => path.version >= (newest[path.id]?.version ?? 0));
    this.store.set({ newest: { ...newest, ...Object.fromEntries(newer.map((path) => [path.id, path])) } });
  }

  // A task that is gone, or none, gives way to the one that was chosen in this browser tab, else to the newest.
  #choose(tasks) {
    const names = tasks.map((task) => task.name);
    if (names.includes(this.store.state.task)) return;
    const kept = sessionStorage.getItem(CHOSEN);
    this.store.set({ task: names.includes(kept) ? kept : (names.at(-1) ?? "") });
  }

  #connect(connected) {
    const socket = new WebSocket(socketAddress("events"));
    socket.onmessage = ({ data }) => {
      if (this.connection !== "live") {
        this.#pause = SHORTEST;
        this.connection = "live";
        connected("live");
      }
      this.#hear(JSON.parse(data));
    };
    socket.onclose = () => {
      const wait = this.#pause * (0.75 + Math.random() / 2);
      this.#pause = Math.min(LONGEST, this.#pause * 2);
      this.connection = "lost";
      connected("lost", wait / 1000);
      setTimeout(() => this.#connect(connected), wait);
    };
  }

  #hear(piece) {
    if (piece.topic === "all") {
      if (piece.reason === "connected") {
        this.#standing = {}; // how things stand follows
        for (const topic of STANDING) this.#stand(topic);
      }
      this.readAll();
    } else if ("now" in piece) {
      const things = { ...this.#standing[piece.topic], [piece.id]: piece.now };
      if (piece.now === null) delete things[piece.id];
      this.#standing[piece.topic] = things;
      this.#stand(piece.topic);
    } else {
      this.read(...(READ[piece.topic] ?? []));
    }
    for (const hear of this.#listeners.get(piece.topic) ?? []) hear(piece);
  }

  #stand(topic) {
    const things = this.#standing[topic] ?? {};
    const now = {
      station: () => things[""] ?? null,
      executor: () => things[""] ?? null,
      trackers: () => Object.entries(things).map(([name, tracker]) => ({ name, ...tracker })).sort((a, b) => a.name.localeCompare(b.name)),
      recordings: () => Object.values(things),
      guidance: () => Object.fromEntries(Object.entries(things).map(([task, { sentence }]) => [task, sentence])),
    }[topic];
    if (now) this.store.set({ [topic]: now() });
  }
}
