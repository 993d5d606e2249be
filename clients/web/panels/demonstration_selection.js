// Several demonstrations at once: chosen in the list, then marked, discarded, restored or moved to another task.
import { get, patch, post, read, remove, resourcePath, upload } from "../api.js";
import { blocked, element, option } from "../elements.js";
import { formatNumber, pluralize } from "../texts.js";

const POLL_INTERVAL = 300; // [ms] between two looks at an import, which is heard of for the chosen task only

/** @type {Record<string, [name: string, changes: object]>} */
const CHANGES = {
  good: ["Mark good", { mark: "good" }],
  bad: ["Mark bad", { mark: "bad" }],
  none: ["No mark", { mark: "" }],
  discard: ["Discard", { discarded: true }],
  restore: ["Restore", { discarded: false }],
};

export class DemonstrationSelection {
  isOn = false; // whether the list shows what is chosen
  /** @type {Set<string>} */
  ids = new Set();
  #doing = ""; // what is done now, and how far

  /** @param {() => void} onChange */
  constructor(onChange) {
    this.onChange = onChange;
  }

  /** @param {boolean} isOn */
  turn(isOn) {
    this.isOn = isOn;
    this.ids = new Set();
    this.onChange();
  }

  /** @param {string} id @param {boolean} isChosen */
  choose(id, isChosen) {
    if (isChosen) this.ids.add(id);
    else this.ids.delete(id);
    this.onChange();
  }

  /** Choose all that a filter finds, or none when all are chosen. @param {Demonstration[]} found */
  toggleAll(found) {
    const all = found.every(({ id }) => this.ids.has(id));
    this.ids = new Set(all ? [] : found.map(({ id }) => id));
    this.onChange();
  }

  /**
   * Change all that are chosen, one after the other; stops at the first that is refused, and says how far it came.
   * @param {string} verb a key of CHANGES
   */
  change(verb) {
    const [name, changes] = CHANGES[verb];
    return this.#each(name, (id) => patch(resourcePath("demonstrations", id), changes));
  }

  /**
   * Import all that are chosen into another task, all or none; then they are discarded where they were.
   * @param {string} task
   */
  async move(task) {
    /** @type {{upload: string, name: string, format: string}[]} */
    const files = [];
    try {
      await this.#each(`Move to ${task}`, async (id) => {
        const content = await read(`${resourcePath("demonstrations", id, "export")}?format=mcap`);
        const { id: sent } = await upload("uploads", content);
        files.push({ upload: sent, name: id, format: "mcap" });
      });
      await ended(await post(resourcePath("tasks", task, "imports"), { files }));
    } catch (error) {
      for (const file of files) remove(resourcePath("uploads", file.upload)).catch(() => null); // they are forgotten otherwise
      throw error;
    }
    await this.change("discard");
  }

  /** @param {string} what @param {(id: string) => Promise<unknown>} order */
  async #each(what, order) {
    const ids = [...this.ids];
    try {
      for (const [k, id] of ids.entries()) {
        this.#doing = `${what}: ${k} of ${ids.length}`;
        this.onChange();
        await order(id).catch((error) => {
          throw new Error(`${what}: ${k} of ${ids.length} done, then: ${error.message}`);
        });
      }
    } finally {
      this.#doing = "";
      this.onChange();
    }
  }

  /**
   * What can be done with what is chosen.
   * @param {Demonstration[]} found by the filter
   * @param {Pick<Task, "name" | "display_name">[]} others the other tasks
   */
  toolbar(found, others) {
    if (!this.isOn)
      return element("p", { class: "buttons" }, button("select", "Select several", { "data-select": "on" }));
    const count = this.ids.size;
    const why = this.#doing || (count === 0 ? "Select demonstrations in the list first." : "");
    const all = found.length > 0 && found.every(({ id }) => this.ids.has(id));
    return [
      element(
        "p",
        { class: "buttons" },
        button("select", "Done", { "data-select": "off" }),
        button("all", all ? "Select none" : `Select all ${formatNumber(found.length, 0)}`, { "data-select": "all" }),
        element(
          "span",
          { class: "note", role: "status" },
          this.#doing || `${count} ${pluralize(count, "demonstration")} selected`,
        ),
      ),
      element(
        "p",
        { class: "buttons" },
        Object.entries(CHANGES).map(([verb, [name]]) => button(verb, name, { "data-change": verb, ...blocked(why) })),
        others.length > 0 &&
          element(
            "select",
            { "data-move": "1", "data-key": "move", "aria-label": "Move them to another task", ...blocked(why) },
            option("", "Move to …"),
            others.map(({ name, display_name }) => option(name, display_name || name)),
          ),
      ),
    ];
  }
}

/** @param {string} key @param {string} text @param {import("../elements.js").Attributes} attributes */
const button = (key, text, attributes) =>
  element("button", { type: "button", "data-key": `several ${key}`, ...attributes }, text);

/** Wait for a job; throws what it says when it has not succeeded. @param {Job} job */
async function ended(job) {
  let now = job;
  while (!now.finished_ns) {
    await new Promise((resolve) => setTimeout(resolve, POLL_INTERVAL));
    now = await get(resourcePath("jobs", job.id));
  }
  if (now.state !== "succeeded") throw new Error(now.message || `the import was ${now.state}`);
}
