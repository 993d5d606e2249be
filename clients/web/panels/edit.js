// Edit: the chosen path's control points, knots and versions; the curve itself is edited in the 3-D view.
import { adaptationSection } from "../editor/adaptation.js";
import { certificationSection, isCertified } from "../editor/certification.js";
import { controlPointsSection } from "../editor/control_points.js";
import { Editor } from "../editor/editor.js";
import { feasibilitySection } from "../editor/feasibility.js";
import { KEYBOARD_HELP } from "../editor/keyboard.js";
import { knotsSection } from "../editor/knots.js";
import { saveForm } from "../editor/save_form.js";
import { versionsSection } from "../editor/versions.js";
import { block, closestData, element, foldedSection, hideSection, hint, section, tabButton } from "../elements.js";
import { icon } from "../icons.js";
import { patchChildren } from "../patch_children.js";
import { changesAny, selectedPath } from "../store.js";
import { wayClass } from "../way_colors.js";

const NO_PATH_SENTENCE =
  "Nothing to edit yet. Learn the ways of a task first; each has a path, whose control points can be dragged here.";

const VERDICTS = {
  yes: ["good", "The arm can probably follow"],
  no: ["failed", "The arm cannot follow"],
  unknown: ["hint", "Being assessed …"],
  certified: ["good", "This version is certified"],
};

/** @type {EditPanel | null} */
let edit = null;

export const panel = {
  id: "edit",
  title: "Edit",
  /** @type {Panel["mount"]} */
  mount(place, context) {
    edit = new EditPanel(place, context);
  },
  /** @type {Section["update"]} */
  update(state, changed) {
    if (changesAny(changed, "runs", "selectedRun", "path")) edit?.openPath(state);
  },
  show: () => edit?.editor.show(true),
  hide: () => edit?.editor.show(false),
  /** For the browser tests. */
  get editor() {
    return edit?.editor;
  },
};

class EditPanel {
  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    const editor = new Editor(context);
    this.editor = editor;
    this.empty = section(place, "edit-empty", "Path");
    this.sections = element("div", { id: "edit", hidden: "" });
    place.append(this.sections);
    this.pathButtons = element("div", { class: "row choice", role: "group", "aria-label": "path to edit" });
    const steps = undoButtons(editor);
    section(this.sections, "edit-path", "Path").append(this.pathButtons, steps.element);
    const foot = element("div", { class: "edit-foot" });
    editor.add(
      steps,
      verdictLine(editor, foot),
      feasibilitySection(section(this.sections, "edit-arm", "Can the arm follow?"), editor),
      controlPointsSection(section(this.sections, "edit-place", "Control points"), editor),
      adaptationSection(section(this.sections, "edit-adaptation", "An object that lies elsewhere"), editor),
      knotsSection(foldedSection(this.sections, "edit-knots", "Knots"), editor),
      saveForm(section(this.sections, "edit-saving", "Save"), editor, foot),
      certificationSection(section(this.sections, "edit-certifying", "Certify"), editor, foot),
      versionsSection(foldedSection(this.sections, "edit-versions", "Versions"), editor),
    );
    this.sections.append(foot);
    this.pathButtons.addEventListener("click", (event) => {
      const { path } = closestData(event);
      if (path) context.store.set({ path });
    });
    context.eventStream.on("paths", async ({ id }) => {
      await editor.opened.catch(() => {}); // its list may be from before this version
      if (id === editor.draft?.path) editor.readVersions().catch(() => {});
    });
  }

  /** @param {State} state */
  openPath(state) {
    const [path, run] = [selectedPath(state), state.selectedRun];
    hideSection(this.empty, Boolean(path));
    this.sections.hidden = !path;
    if (!path || !run) {
      patchChildren(this.empty, hint(NO_PATH_SENTENCE), tabButton("ways", "Go to the ways"));
      if (this.editor.draft) this.editor.close();
      return;
    }
    const { paths, clusters } = run.learned;
    patchChildren(
      this.pathButtons,
      paths.map((other) => pathButton(other, other.id === path.id)),
    );
    const spread = clusters.find(({ index }) => index === path.cluster)?.spread ?? null;
    this.context.attempt(() => this.editor.open(path.id, spread));
  }
}

/** Whether the arm can follow, in a few words that are always in view. @param {Editor} editor @param {HTMLElement} foot @returns {EditorSection} */
function verdictLine(editor, foot) {
  const line = element("p", { class: "verdict-line" });
  foot.append(line);
  const render = () => {
    const { assessment, error } = editor.feasibility ?? {};
    const assessed = error || assessment?.failure ? VERDICTS.no : assessment ? VERDICTS.yes : VERDICTS.unknown;
    const [look, text] = isCertified(editor) ? VERDICTS.certified : assessed;
    line.className = `verdict-line ${look}`;
    line.textContent = text;
  };
  editor.context.store.subscribe((_state, changed) => {
    if (changed.has("jobs")) render();
  });
  return {
    update({ draft }, what) {
      if (draft && (what === "feasibility" || what === "draft")) render();
    },
  };
}

/** @param {LearnedPath} path @param {boolean} isEdited */
function pathButton({ id, cluster }, isEdited) {
  const attributes = { type: "button", "data-path": id, "data-key": id, "aria-pressed": String(isEdited) };
  return element("button", attributes, element("span", { class: `swatch ${wayClass(cluster)}` }), `Way ${cluster}`);
}

/** @param {Editor} editor @returns {EditorSection & {element: HTMLElement}} */
function undoButtons(editor) {
  /** @param {string} id @param {string} text @param {string} keys @param {() => void} onClick */
  const button = (id, text, keys, onClick) => {
    const made = element("button", { type: "button", id: `edit-${id}`, "aria-keyshortcuts": keys || null }, text);
    made.addEventListener("click", onClick);
    return made;
  };
  const undo = button("undo", "Undo", "Control+Z", () => editor.undo());
  const redo = button("redo", "Redo", "Control+Shift+Z", () => editor.redo());
  const revert = button("revert", "Back to the version", "", () => {
    if (editor.draft) editor.change(editor.draft.original, "going back to the version");
  });
  for (const [one, drawing] of /** @type {const} */ ([
    [undo, "undo"],
    [redo, "redo"],
  ]))
    one.prepend(icon(drawing));
  const help = element("p", { class: "note" }, `Drag control points in the view. ${KEYBOARD_HELP}`);
  return {
    element: element("div", {}, element("div", { class: "row" }, undo, redo, revert), help),
    update({ draft }, what) {
      if (!draft || what === "drag" || what === "feasibility") return;
      block(undo, draft.undoLabel ? "" : "There is no step to undo.", `Undo ${draft.undoLabel}`);
      block(redo, draft.redoLabel ? "" : "No step was undone.", `Redo ${draft.redoLabel}`);
      block(revert, draft.edited ? "" : "Nothing was edited since this version.");
    },
  };
}
