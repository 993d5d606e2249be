// What is done with the chosen task as a whole, in a popover of the header: rename it, delete it; and bring back deleted ones.
import { getList, patch, post, remove, resourcePath } from "./api.js";
import { displayNameOf, idOf, nameField, taskTitle } from "./display_names.js";
import { block, blocked, closestData, element, hint } from "./elements.js";
import { missingSentence } from "./identity.js";
import { patchChildren } from "./patch_children.js";
import { changesAny } from "./store.js";
import { formatMoment } from "./texts.js";

const ABOUT_DELETING = "All of it is kept: it leaves the lists, and can be brought back below.";
const NONE_DELETED = "No task was deleted.";

/** @param {HTMLElement} place a popover @param {Context} context */
export function taskMenu(place, context) {
  const menu = new TaskMenu(place, context);
  context.store.subscribe((state, changed) => {
    if (changesAny(changed, "task", "recordings", "jobs", "identity")) menu.update(state, changed.has("task"));
    if (changed.has("tasks") && place.matches(":popover-open")) menu.readDeleted();
  });
}

class TaskMenu {
  #reads = 0; // of the deleted tasks: only the newest one's answer counts
  /** @type {Task[]} */
  #deleted = [];

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, { store, eventStream, messages }) {
    this.place = place;
    this.store = store;
    this.eventStream = eventStream;
    this.messages = messages;
    this.title = element("h2", {});
    this.name = element("input", { type: "text", id: "other-task-name", required: "", autocomplete: "off" });
    this.id = element("p", { class: "note" });
    this.showId = nameField(this.name, this.id);
    this.renameButton = element("button", { type: "submit" }, "Rename");
    this.deleteButton = element("button", { type: "button" }, "Delete the task");
    this.why = element("p", { class: "note" });
    this.deletedList = element("ul", { class: "access", "aria-label": "deleted tasks" });
    this.refusal = element("p", { class: "error", role: "alert" });
    const field = element("p", { class: "field" }, element("label", { for: "other-task-name" }, "New name"), this.name);
    field.append(this.renameButton);
    const form = element("form", {}, field, this.id);
    const buttons = element("p", { class: "buttons" }, this.deleteButton);
    place.append(this.title, form, buttons, this.why, this.refusal);
    place.append(element("h2", {}, "Deleted tasks"), this.deletedList);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#attempt(() => this.#rename(store.state.task, this.name.value.trim()));
    });
    this.deleteButton.addEventListener("click", () => this.#attempt(() => this.#delete(store.state.task)));
    this.deletedList.addEventListener("click", (event) => {
      const { bringBack } = closestData(event);
      if (bringBack) this.#attempt(() => this.#restore(bringBack));
    });
    // The toggle comes only after a while, when a person may have typed a name already.
    place.addEventListener("beforetoggle", (event) => {
      if (!(event instanceof ToggleEvent) || event.newState !== "open") return;
      this.update(store.state, true);
      this.readDeleted();
    });
    this.update(store.state, true);
  }

  /** @param {State} state @param {boolean} isOther whether another task is meant than before */
  update(state, isOther) {
    const why = changeRefusal(state);
    const title = taskTitle(state.tasks, state.task);
    this.title.textContent = title ? `Task ${title}` : "No task";
    if (isOther) {
      [this.name.value, this.refusal.textContent] = [title, ""];
      this.showId();
    }
    for (const control of [this.name, this.renameButton, this.deleteButton]) block(control, why);
    this.why.textContent = why || ABOUT_DELETING;
    this.#renderDeleted();
  }

  async readDeleted() {
    const request = ++this.#reads;
    const deleted = await getList("tasks?archived=true").catch(() => null); // the connection's state says why
    if (!deleted || request !== this.#reads) return;
    this.#deleted = deleted;
    this.#renderDeleted();
  }

  #renderDeleted() {
    const why = missingSentence(this.store.state.identity, ["teach"]);
    const rows = this.#deleted.map((task) => deletedRow(task, why));
    patchChildren(this.deletedList, rows.length ? rows : element("li", {}, hint(NONE_DELETED)));
  }

  /** Do something with tasks; a refusal stands in the popover, which is closed after what was done. @param {() => Promise<void>} order */
  async #attempt(order) {
    this.refusal.textContent = "";
    this.messages.clear(); // its undo is of what was done before
    try {
      await order();
      this.place.hidePopover();
    } catch (error) {
      this.refusal.textContent = error instanceof Error ? error.message : String(error);
      this.refusal.scrollIntoView({ block: "nearest" });
    }
  }

  /** @param {string} task @param {string} called what people call it from now on */
  async #rename(task, called) {
    const before = taskTitle(this.store.state.tasks, task);
    if (before === called) return;
    const to = idOf(called);
    await patch(resourcePath("tasks", task), { name: to, display_name: displayNameOf(called) });
    await this.#choose(to);
    this.messages.show(`Task ${before} is called ${called} now.`, "note", {
      label: "Undo",
      order: () => this.#rename(to, before),
    });
  }

  /** @param {string} task */
  async #delete(task) {
    const title = taskTitle(this.store.state.tasks, task);
    await remove(resourcePath("tasks", task));
    await this.eventStream.read("tasks"); // which chooses another one
    const undo = { label: "Undo", order: () => this.#restore(task) };
    this.messages.show(`Task ${title} is deleted; all of it is kept.`, "note", undo);
  }

  /** @param {string} task */
  async #restore(task) {
    await post(resourcePath("tasks", task, "restore"));
    await this.#choose(task);
    this.messages.show(`Task ${taskTitle(this.store.state.tasks, task)} is back.`);
  }

  /** Choose a task that the list may not have yet. @param {string} task */
  async #choose(task) {
    await this.eventStream.read("tasks");
    this.store.set({ task });
  }
}

/** @param {Task} task @param {string} why it cannot be brought back; "": it can */
function deletedRow({ name, display_name, archived_ns }, why) {
  return element(
    "li",
    { "data-key": name },
    element("span", {}, element("b", {}, display_name || name), ` deleted ${formatMoment(archived_ns)}`),
    element("button", { type: "button", "data-bring-back": name, ...blocked(why) }, "Bring back"),
  );
}

/**
 * Why the chosen task can be neither renamed nor deleted now; empty when it can.
 * @param {Pick<State, "task" | "recordings" | "jobs" | "identity">} state
 */
export function changeRefusal({ task, recordings, jobs, identity }) {
  if (!task) return "There is no task yet: make one, or bring one back.";
  const recording = recordings.find((one) => one.task === task);
  if (recording) return `It is being recorded from ${recording.tracker}: finish that first.`;
  if (jobs?.some(({ state }) => state === "queued" || state === "running"))
    return "The station is learning or planning for it: wait for that, or cancel it.";
  return missingSentence(identity, ["teach"]);
}
