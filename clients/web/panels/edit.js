// Edit: the chosen path's control points, knots and versions; the curve itself is edited in the 3-D view.
import { certificationSection } from "../editor/certification.js";
import { controlPointsSection } from "../editor/control_points.js";
import { Editor } from "../editor/editor.js";
import { feasibilitySection } from "../editor/feasibility.js";
import { KEYBOARD_HELP } from "../editor/keyboard.js";
import { knotsSection } from "../editor/knots.js";
import { saveForm } from "../editor/save_form.js";
import { versionsSection } from "../editor/versions.js";
import { element, hint, patchChildren, section, tabButton } from "../elements.js";
import { selectedPath, selectedRun } from "../store.js";
import { wayClass } from "../way_colors.js";

let context, editor, empty, sections, pathButtons, buttons;

export const panel = {
  id: "edit",
  title: "Edit",

  mount(place, given) {
    context = given;
    editor = new Editor(context);
    empty = section(place, "edit-empty", "Path");
    sections = element("div", { id: "edit", hidden: "" });
    place.append(sections);
    pathButtons = element("div", { class: "row choice", role: "group", "aria-label": "path to edit" });
    const path = section(sections, "edit-path", "Path");
    path.append(pathButtons, undoButtons());
    editor.add(
      { update: updateButtons },
      feasibilitySection(section(sections, "edit-arm", "Can the arm follow?"), editor),
      controlPointsSection(section(sections, "edit-place", "Control points"), editor),
      knotsSection(section(sections, "edit-knots", "Knots"), editor),
      saveForm(section(sections, "edit-saving", "Save"), editor),
      certificationSection(section(sections, "edit-certifying", "Certify"), editor),
      versionsSection(section(sections, "edit-versions", "Versions"), editor),
    );
    pathButtons.addEventListener("click", (event) => {
      const id = event.target.closest("button")?.dataset.path;
      if (id) context.store.set({ path: id });
    });
    context.eventStream.on("paths", async (piece) => {
      await editor.opened.catch(() => {}); // its list may be from before this version
      if (piece.id === editor.draft?.path) editor.readVersions().catch(() => {});
    });
  },

  update(state, changed) {
    if (["runs", "run", "path"].some((name) => changed.has(name))) openPath(state);
  },

  show() {
    editor.show(true);
  },

  hide() {
    editor?.show(false);
  },

  // For the browser tests, and the curious.
  get editor() {
    return editor;
  },
};

function openPath(state) {
  const path = selectedPath(state);
  empty.parentElement.hidden = Boolean(path);
  sections.hidden = !path;
  if (!path) {
    patchChildren(
      empty,
      hint(
        "Nothing to edit yet. Learn the ways of a task first; each has a path, whose control points can be dragged here.",
      ),
      tabButton("ways", "Go to the ways"),
    );
    if (editor.draft) editor.close();
    return;
  }
  const { learned } = selectedRun(state);
  const paths = learned.paths.map((other) =>
    element(
      "button",
      { type: "button", "data-path": other.id, "data-key": other.id, "aria-pressed": String(other.id === path.id) },
      element("span", { class: `swatch ${wayClass(other.cluster)}` }),
      `Way ${other.cluster}`,
    ),
  );
  patchChildren(pathButtons, ...paths);
  const spread = learned.clusters.find(({ index }) => index === path.cluster)?.spread;
  context.attempt(() => editor.open(path.id, spread));
}

function undoButtons() {
  const button = (id, words, keys, order) => {
    const made = element("button", { type: "button", id: `edit-${id}`, "aria-keyshortcuts": keys }, words);
    made.addEventListener("click", order);
    return made;
  };
  buttons = {
    undo: button("undo", "Undo", "Control+Z", () => editor.undo()),
    redo: button("redo", "Redo", "Control+Shift+Z", () => editor.redo()),
  };
  const revert = button("revert", "Back to the version", "", () =>
    editor.change(editor.draft.original, "going back to the version"),
  );
  buttons.revert = revert;
  return element(
    "div",
    {},
    element("div", { class: "row" }, Object.values(buttons)),
    element("p", { class: "note" }, `Drag control points in the view. ${KEYBOARD_HELP}`),
  );
}

function updateButtons({ draft }, what) {
  if (!draft || what === "drag" || what === "feasibility") return;
  buttons.undo.disabled = !draft.undoLabel;
  buttons.undo.title = draft.undoLabel ? `Undo ${draft.undoLabel}` : "";
  buttons.redo.disabled = !draft.redoLabel;
  buttons.redo.title = draft.redoLabel ? `Redo ${draft.redoLabel}` : "";
  buttons.revert.disabled = !draft.edited;
}
