// Edit: the chosen path's control points, knots and versions; the curve itself is edited in the 3-D view.
import { certifying } from "../editor/certification.js";
import { Editor } from "../editor/editor.js";
import { HELP } from "../editor/keyboard.js";
import { knots } from "../editor/knots.js";
import { points } from "../editor/control_points.js";
import { saving } from "../editor/save_form.js";
import { verdict } from "../editor/feasibility.js";
import { versions } from "../editor/versions.js";
import { element, hint, next, replace, section } from "../elements.js";
import { pathOf, runOf } from "../store.js";

const WAYS = 6; // colours --way-0 to --way-5
let context, editor, empty, parts, choice, steps;

export const panel = {
  id: "edit",
  title: "Edit",

  mount(place, given) {
    context = given;
    editor = new Editor(context);
    empty = section(place, "edit-empty", "Path");
    parts = element("div", { id: "edit", hidden: "" });
    place.append(parts);
    choice = element("div", { class: "row choice", role: "group", "aria-label": "path to edit" });
    const path = section(parts, "edit-path", "Path");
    path.append(choice, undoing());
    editor.add(
      { update: update },
      verdict(section(parts, "edit-arm", "Can the arm follow?"), editor),
      points(section(parts, "edit-place", "Control points"), editor),
      knots(section(parts, "edit-knots", "Knots"), editor),
      saving(section(parts, "edit-saving", "Save"), editor),
      certifying(section(parts, "edit-certifying", "Certify"), editor),
      versions(section(parts, "edit-versions", "Versions"), editor),
    );
    choice.addEventListener("click", (event) => {
      const id = event.target.closest("button")?.dataset.path;
      if (id) context.store.set({ path: id });
    });
    context.feed.on("paths", async (piece) => {
      await editor.opened.catch(() => {}); // its list may be from before this version
      if (piece.id === editor.draft?.path) editor.readVersions().catch(() => {});
    });
  },

  update(state, changed) {
    if (["runs", "run", "path"].some((name) => changed.has(name))) open(state);
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

function open(state) {
  const path = pathOf(state);
  empty.parentElement.hidden = Boolean(path);
  parts.hidden = !path;
  if (!path) {
    replace(empty, hint("Nothing to edit yet. Learn the ways of a task first; each has a path, whose control points can be dragged here."), next("ways", "Go to the ways"));
    if (editor.draft) editor.close();
    return;
  }
  const { learned } = runOf(state);
  const paths = learned.paths.map((other) =>
    element(
      "button",
      { type: "button", "data-path": other.id, "data-key": other.id, "aria-pressed": String(other.id === path.id) },
      element("span", { class: `swatch way-${(other.cluster - 1) % WAYS}` }),
      `Way ${other.cluster}`,
    ),
  );
  replace(choice, ...paths);
  const spread = learned.clusters.find(({ index }) => index === path.cluster)?.spread;
  context.attempt(() => editor.open(path.id, spread));
}

function undoing() {
  const button = (id, words, keys, order) => {
    const made = element("button", { type: "button", id: `edit-${id}`, "aria-keyshortcuts": keys }, words);
    made.addEventListener("click", order);
    return made;
  };
  steps = { undo: button("undo", "Undo", "Control+Z", () => editor.undo()), redo: button("redo", "Redo", "Control+Shift+Z", () => editor.redo()) };
  const revert = button("revert", "Back to the version", "", () => editor.change(editor.draft.original, "going back to the version"));
  steps.revert = revert;
  return element("div", {}, element("div", { class: "row" }, Object.values(steps)), element("p", { class: "note" }, `Drag control points in the view. ${HELP}`));
}

function update({ draft }, what) {
  if (!draft || what === "drag" || what === "verdict") return;
  steps.undo.disabled = !draft.undoable;
  steps.undo.title = draft.undoable ? `Undo ${draft.undoable}` : "";
  steps.redo.disabled = !draft.redoable;
  steps.redo.title = draft.redoable ? `Redo ${draft.redoable}` : "";
  steps.revert.disabled = !draft.edited;
}
