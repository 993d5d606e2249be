// Reads the lists of the state: whole, page by page, and after that only what has changed.
import { get, getList, getPage, isPassing, RETRY_DELAY, resourcePath } from "./api.js";

const MAX_SINGLE_READS = 20; // changed entries; when there are more, the list is read whole

/** @typedef {"tasks" | "executions" | "demonstrations" | "runs" | "jobs"} ListName a list of the state */

/** @typedef {{id: string, created_ns: number, task?: string, number?: number}} Entry of a list but that of the tasks */

/** @type {ListName[]} */
export const TASK_LISTS = ["demonstrations", "runs", "jobs"];

/** @type {ListName[]} */
const HISTORIES = ["executions", "runs", "jobs"]; // newest first; what is new stands on the first page

export class ListReader {
  /** @type {Set<ListName>} */
  #whole = new Set(); // lists to read whole
  /** @type {Map<ListName, Set<string>>} */
  #changed = new Map(); // ids of the entries to read
  /** @type {Set<ListName>} */
  #unread = new Set(); // lists that could not be read, by a fault that passes
  /** @type {Promise<void> | null} */
  #reading = null; // the rounds under way

  /**
   * @param {import("./store.js").Store} store
   * @param {(name: ListName, list: any[], task: string) => Promise<void>} onList called with a list that was read, and its task
   */
  constructor(store, onList) {
    this.store = store;
    this.onList = onList;
  }

  /**
   * Read lists whole. What is asked for meanwhile is read in the next round; resolves when all has been read.
   * @param {...ListName} names
   */
  read(...names) {
    for (const name of names) this.#whole.add(name);
    return this.#begin();
  }

  /**
   * Read one entry of a list that has changed, or is new.
   * @param {ListName} name
   * @param {string} id
   */
  readEntry(name, id) {
    const ids = this.#changed.get(name) ?? new Set();
    this.#changed.set(name, ids.add(id));
    return this.#begin();
  }

  #begin() {
    if (this.#whole.size + this.#changed.size) this.#reading ??= this.#readRounds();
    return this.#reading;
  }

  async #readRounds() {
    try {
      while (this.#whole.size + this.#changed.size) await this.#readRound();
    } finally {
      this.#reading = null;
    }
    if (!this.#unread.size) return;
    const names = [...this.#unread];
    this.#unread.clear();
    setTimeout(() => this.read(...names), RETRY_DELAY);
  }

  async #readRound() {
    const [whole, changed] = [[...this.#whole], [...this.#changed]];
    this.#whole.clear();
    this.#changed.clear();
    const entries = changed.filter(([name]) => !whole.includes(name));
    await Promise.all([
      ...whole.map((name) => this.#readList(name)),
      ...entries.map(([name, ids]) => this.#readEntries(name, [...ids])),
    ]);
  }

  /**
   * What was read, or null: no event comes for what failed, so that it is read again where that may help.
   * @template T
   * @param {ListName} name
   * @param {Promise<T>} read
   * @returns {Promise<T | null>}
   */
  #orNull(name, read) {
    return read.catch((error) => {
      if (isPassing(error)) this.#unread.add(name);
      return null;
    });
  }

  /** @param {ListName} name */
  async #readList(name) {
    const { task } = this.store.state;
    const isOfTask = TASK_LISTS.includes(name);
    if (isOfTask && !task) return;
    const list = await this.#orNull(name, getList(isOfTask ? resourcePath("tasks", task, name) : name));
    if (list && (task === this.store.state.task || !isOfTask)) await this.onList(name, list, task);
  }

  /**
   * @param {ListName} name
   * @param {string[]} ids
   */
  async #readEntries(name, ids) {
    const { task } = this.store.state;
    const isOfTask = TASK_LISTS.includes(name);
    if (ids.length > MAX_SINGLE_READS || name === "tasks" || !this.store.state[name]) return this.#readList(name);
    const path = (/** @type {string} */ id) => resourcePath(name, id);
    const read =
      name === "runs" // a run is long, and all that the list says of it stands on the list's first page
        ? getPage(resourcePath("tasks", task, name)).then(({ entries }) => entries)
        : Promise.all(ids.map((id) => get(path(id))));
    const entries = /** @type {Entry[] | null} */ (await this.#orNull(name, read));
    const present = /** @type {Entry[] | null} */ (this.store.state[name]);
    if (!entries || !present || (isOfTask && task !== this.store.state.task)) return;
    const own = isOfTask ? entries.filter((entry) => entry.task === task) : entries;
    await this.onList(name, merged(present, own, HISTORIES.includes(name)), task);
  }
}

/**
 * A list with entries that were read anew, in its order.
 * @param {Entry[]} present
 * @param {Entry[]} entries
 * @param {boolean} isHistory
 */
export function merged(present, entries, isHistory) {
  const fresh = new Map(entries.map((entry) => [entry.id, entry]));
  const list = present.map((entry) => fresh.get(entry.id) ?? entry);
  const known = new Set(present.map(({ id }) => id));
  const added = entries.filter(({ id }) => !known.has(id));
  if (!added.length) return list;
  return isHistory
    ? [...added, ...list].sort((a, b) => b.created_ns - a.created_ns)
    : [...list, ...added].sort((a, b) => (a.number ?? 0) - (b.number ?? 0));
}
