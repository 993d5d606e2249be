// Files that other programs wrote: dropped or chosen, looked at, corrected, and imported into the task, all or none.
import { get, patch, post, resourcePath } from "../api.js";
import { displayNameOf, idOf, taskTitle } from "../display_names.js";
import { blocked, closestData, element, hint } from "../elements.js";
import { fileCard, formatColumns, parseColumns } from "../files/file_card.js";
import { FileImport, NO_MARKS, numbered } from "../files/file_import.js";
import { importProgress, importSummary, standing } from "../files/import_elements.js";
import { listenForMarks } from "../files/mark_input.js";
import { isName, nameRefusal } from "../names.js";
import { readNumber } from "../number_input.js";
import { patchChildren } from "../patch_children.js";
import { changesAny } from "../store.js";
import { capitalize } from "../texts.js";

const IMPORT_HELP =
  "Recordings of other programs: tables, motion capture, poses, arrays, or files that were saved here. Drop them on the page, or choose them.";
const FIRST_TASK = "imported";
const LINES = { motion: "import-motion", carried: "import-carried" };

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function importFiles(place, context) {
  if (context.readOnly) return { update: () => {} };
  const panel = new ImportPanel(place, context);
  return {
    update: (state, changed) => panel.update(state, changed),
    show: () => panel.setShown(true),
    hide: () => panel.setShown(false),
  };
}

class ImportPanel {
  called = ""; // what people call the task that the import makes; "": by its name
  open = ""; // id of the file that is looked at
  /** @type {import("../files/file_card.js").ReaderName[]} */
  readers = [];
  /** @type {ReturnType<typeof numbered> | null} */
  summary = null; // of the last import
  #isShown = true;

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.input = element("input", { type: "file", multiple: "", hidden: "", "aria-label": "Files to import" });
    this.task = element("input", { type: "text", id: "import-task", autocomplete: "off" });
    this.atGrasp = element("input", { type: "checkbox", id: "import-at-grasp" });
    this.cards = element("div", {});
    this.target = element("div", {}, targetFields(this.task, this.atGrasp));
    this.foot = element("div", {});
    place.append(this.input, this.cards, this.target, this.foot);
    this.files = new FileImport(
      () => ({ task: this.#task(), objectAtGrasp: this.atGrasp.checked }),
      () => this.#render(),
    );
    this.input.addEventListener("change", () => {
      this.#add([...(this.input.files ?? [])]);
      this.input.value = "";
    });
    for (const control of [this.task, this.atGrasp])
      control.addEventListener("change", () => this.files.examineAgain(...this.files.files));
    place.addEventListener("click", (event) => this.#click(event));
    this.cards.addEventListener("change", (event) => this.#change(event));
    this.#listenForDrops();
    listenForMarks(this.cards, {
      times: (id) => this.files.find(id)?.report?.times,
      marks: (id) => this.files.find(id)?.shownMarks ?? NO_MARKS,
      onMark: (id, mark, time) => this.#mark(id, mark, time),
    });
    context.eventStream.on("jobs", ({ id }) => {
      if (id === this.files.job?.id) this.#readJob();
    });
    this.#render();
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (changed.has("connection") && state.connection === "live") this.#readJob();
    if (!changesAny(changed, "task", "tasks")) return;
    if (changed.has("task") && !this.files.job) {
      this.task.value = taskTitle(state.tasks, state.task);
      this.files.examineAgain(...this.files.files);
    }
    this.#render();
  }

  /** @param {boolean} isShown */
  setShown(isShown) {
    this.#isShown = isShown;
    this.#draw();
  }

  /** What the task is called that is imported into. */
  #title() {
    const { task, tasks } = this.context.store.state;
    return this.task.value.trim() || taskTitle(tasks, task) || FIRST_TASK;
  }

  /** Its name: that of the task which is called so, else the one that is made of it. */
  #task() {
    const title = this.#title();
    const called = this.context.store.state.tasks?.find((task) => task.display_name === title);
    return called?.name ?? (idOf(title) || title);
  }

  /** @param {File[]} files */
  async #add(files) {
    if (!files.length || this.files.job) return;
    this.summary = null;
    if (!this.task.value) this.task.value = this.#title();
    const before = new Set(this.files.files);
    this.files.add(files);
    this.open ||= this.files.files.find((file) => !before.has(file))?.id ?? "";
    this.#render();
    if (!this.readers.length) this.readers = (await this.context.attempt(() => get("readers"))) ?? [];
    this.#render();
  }

  /** @param {MouseEvent} event */
  #click(event) {
    const data = closestData(event);
    const file = this.files.find(data.remove ?? data.toggle ?? data.again ?? data.unmark ?? data.all ?? "");
    if (data.choose) this.input.click();
    if (data.clear) this.files.remove(...this.files.files);
    if (data.import) this.context.attempt(() => this.#import());
    if (data.cancel) this.context.attempt(() => post(resourcePath("jobs", data.cancel ?? "", "cancel")));
    if (data.done) this.summary = null;
    if (file && data.remove) this.files.remove(file);
    if (file && data.again) this.files.examineAgain(file);
    if (file && data.unmark) this.files.mark(file, {});
    if (file && data.all) this.files.chooseForAll(file);
    if (file && data.toggle) this.open = this.open === file.id ? "" : file.id;
    if (Object.keys(data).length) this.#render();
  }

  /** @param {Event} event */
  #change({ target }) {
    if (!(target instanceof HTMLInputElement || target instanceof HTMLSelectElement)) return;
    const { field, role, file: id = "" } = target.dataset;
    const file = this.files.find(id);
    if (!file) return;
    if (role) {
      const numbers = { ...parseColumns(file.choices.columns), [role]: target.value };
      this.files.choose(file, { columns: formatColumns(numbers) });
    }
    if (target instanceof HTMLInputElement && (field === "grasp" || field === "release" || field === "rate"))
      this.#enter(file, field, target);
    else if (field === "whole" && target instanceof HTMLInputElement) this.files.mark(file, { whole: target.checked });
    else if (field === "motion") this.files.show(file, Number(target.value));
    else if (field) this.files.choose(file, { [field]: target.value });
  }

  /** @param {import("../files/file_import.js").ImportFile} file @param {"grasp" | "release" | "rate"} field @param {HTMLInputElement} input */
  #enter(file, field, input) {
    const { value, fault } = input.value.trim() ? readNumber(input) : { value: null, fault: "" };
    if (fault) {
      this.context.messages.show(`${input.value} ${fault}.`, "error");
      input.value = input.defaultValue; // as it was
      return;
    }
    input.value = String(value ?? "");
    if (field === "rate") this.files.choose(file, { rate: value ?? 0 });
    else this.#mark(file.id, field, value ?? null);
  }

  /** Mark the motion that is shown; the other mark stays where the program found it. @param {string} id @param {"grasp" | "release"} mark @param {number | null} time */
  #mark(id, mark, time) {
    const file = this.files.find(id);
    if (!file) return;
    this.files.mark(file, { ...file.shownMarks, [mark]: time });
  }

  async #import() {
    const task = this.#task();
    if (!isName(task)) throw new Error(nameRefusal("task", task));
    this.called = this.context.store.state.tasks?.some(({ name }) => name === task) ? "" : displayNameOf(this.#title());
    await this.files.begin();
  }

  async #readJob() {
    await this.files.readJob();
    const { job, files } = this.files;
    if (!job?.finished_ns) return;
    this.files.job = null;
    if (job.state === "succeeded") {
      this.summary = numbered(files, job.outcome);
      this.files.files = [];
      this.open = "";
      const { store, eventStream } = this.context;
      if (this.called) await patch(resourcePath("tasks", job.task), { display_name: this.called });
      await eventStream.read("tasks");
      store.set({ task: job.task });
    } else {
      this.context.messages.show(`${capitalize(job.state)}: ${job.message}`, "error");
      this.files.sendAgain();
    }
    this.#render();
  }

  #listenForDrops() {
    /** @param {DragEvent} event */
    const hasFiles = (event) => event.dataTransfer?.types.includes("Files");
    addEventListener("dragover", (event) => {
      if (hasFiles(event)) event.preventDefault();
    });
    addEventListener("drop", (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.context.open("demonstrate");
      this.#add([...(event.dataTransfer?.files ?? [])]);
      this.cards.scrollIntoView({ block: "nearest" });
    });
  }

  #render() {
    const { files, job } = this.files;
    this.target.hidden = !files.length || job !== null;
    patchChildren(this.cards, this.#content());
    patchChildren(this.foot, files.length > 0 && !job && this.#orders());
    for (const input of this.cards.querySelectorAll("input")) {
      if (input === document.activeElement) continue;
      if (input.type === "checkbox") input.checked = input.hasAttribute("checked");
      else input.value = input.getAttribute("value") ?? "";
    }
    this.#draw();
  }

  /** @returns {Child} */
  #content() {
    const { files, job } = this.files;
    if (job) return importProgress(job);
    if (this.summary) return importSummary(this.summary);
    if (!files.length)
      return element(
        "div",
        { class: "drop", "data-key": "drop" },
        hint(IMPORT_HELP),
        element("p", { class: "buttons" }, button("choose", "Choose files")),
      );
    const context = { isOnly: files.length === 1, readers: this.readers };
    return files.map((file) => fileCard(file, { ...context, isOpen: file.id === this.open }));
  }

  #orders() {
    const { files, isReady } = this.files;
    const all = `Import ${files.length === 1 ? "it" : `all ${files.length}`}`;
    const order = { class: "primary", ...blocked(isReady ? "" : standing(files)) };
    return [
      element(
        "p",
        { class: "buttons" },
        button("import", all, order),
        button("choose", "Choose more"),
        button("clear", "Leave all out"),
      ),
      element("p", { class: "note", role: "status" }, standing(files)),
    ];
  }

  /** Draw the motion of the open file in the view, and what is carried of it. */
  #draw() {
    const file = this.#isShown ? this.files.find(this.open) : undefined;
    const { times = [], positions = [] } = file?.report ?? {};
    const { grasp, release } = file?.shownMarks ?? NO_MARKS;
    const carried =
      grasp === null || release === null ? [] : positions.filter((_, k) => times[k] >= grasp && times[k] <= release);
    this.context.overlay.setLine(LINES.motion, positions.length ? positions : null, { opacity: 0.8 });
    this.context.overlay.setLine(LINES.carried, carried.length ? carried : null, { color: 0xd55e00, opacity: 1 });
  }
}

/** @param {string} verb @param {string} text @param {import("../elements.js").Attributes} [attributes] */
const button = (verb, text, attributes = {}) =>
  element("button", { type: "button", [`data-${verb}`]: "1", "data-key": verb, ...attributes }, text);

/** @param {HTMLInputElement} task @param {HTMLInputElement} atGrasp */
function targetFields(task, atGrasp) {
  const about = "of a new task: its object lies where the hand takes it";
  return [
    element("p", { class: "field" }, element("label", { for: task.id }, "Into the task"), task),
    element("p", { class: "check" }, atGrasp, element("label", { for: atGrasp.id }, about)),
  ];
}
