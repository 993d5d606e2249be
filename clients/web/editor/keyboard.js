// The keyboard on the 3-D view: arrows move the selected control points along the robot's axes as they lie in the picture.
//
// Arrows 1 mm, with Shift 10 mm, with Alt 0.1 mm; Page Up and Page Down along z; [ and ] choose the neighbour; Ctrl+A all;
// Escape none. Ctrl+Z and Ctrl+Shift+Z or Ctrl+Y, wherever the focus is but in a text field, undo and redo.
import { closest } from "../elements.js";

const STEP = 0.001; // [m]
/**
 * Where an arrow points in the picture, x to the right and y down.
 * @type {Record<string, number[]>}
 */
const ARROWS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const AXES = [
  [1, 0, 0],
  [-1, 0, 0],
  [0, 1, 0],
  [0, -1, 0],
];

export const KEYBOARD_HELP =
  "Arrow keys move what is selected by 1 mm, Page Up and Page Down along z; with Shift 10 mm, with Alt 0.1 mm. [ and ] choose the neighbour.";

/** @param {Editor} editor @param {import("../overlay.js").Overlay} overlay */
export function bindKeyboard(editor, overlay) {
  const view = overlay.element;
  /** @type {{key: string, by: number[]} | null} */
  let moving = null; // while an arrow is held

  const finish = () => {
    if (!moving) return;
    moving = null;
    editor.drag.end();
  };
  view.addEventListener("keydown", (event) => {
    if (!editor.active) return;
    const by = arrowDirection(event.key, editor, overlay);
    if (by) {
      event.preventDefault();
      const step = STEP * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
      if (moving?.key !== event.key) finish();
      if (!moving && !editor.drag.begin()) return;
      const before = moving?.by ?? [0, 0, 0];
      moving = { key: event.key, by: before.map((value, axis) => value + step * by[axis]) };
      editor.drag.move(moving.by);
    } else if (applySelectionKey(event, editor)) event.preventDefault();
  });
  view.addEventListener("keyup", (event) => event.key === moving?.key && finish());
  view.addEventListener("blur", finish);
  addEventListener("keydown", (event) => {
    if (!editor.active || !(event.ctrlKey || event.metaKey) || closest(event, "input, textarea, dialog *")) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) editor.redo();
    else editor.undo();
  });
}

/**
 * The robot's direction that an arrow means: the horizontal axis that points most nearly there in the picture.
 * @param {string} key
 * @param {Editor} editor
 * @param {import("../overlay.js").Overlay} overlay
 */
function arrowDirection(key, editor, overlay) {
  if (key === "PageUp" || key === "PageDown") return [0, 0, key === "PageUp" ? 1 : -1];
  const wanted = ARROWS[key];
  if (!wanted) return null;
  const from = editor.selectionCenter ?? [0, 0, 0];
  const here = overlay.project(from);
  /** @param {number[]} axis */
  const alignment = (axis) => {
    const there = overlay.project(from.map((value, k) => value + 0.01 * axis[k]));
    if (!here || !there) return 0;
    const [dx, dy] = [there[0] - here[0], there[1] - here[1]];
    return (dx * wanted[0] + dy * wanted[1]) / (Math.hypot(dx, dy) || 1);
  };
  return AXES.reduce((best, axis) => (alignment(axis) > alignment(best) ? axis : best));
}

/** @param {KeyboardEvent} event @param {Editor} editor */
function applySelectionKey(event, editor) {
  const { selected = [], last = 0 } = editor.draft ?? {};
  if (event.key === "Escape") editor.select([]);
  else if (event.key === "]") editor.select([selected.length ? Math.min(last, (selected.at(-1) ?? 0) + 1) : 0]);
  else if (event.key === "[") editor.select([selected.length ? Math.max(0, selected[0] - 1) : last]);
  else if (event.key.toLowerCase() === "a" && (event.ctrlKey || event.metaKey))
    editor.select([...Array(last + 1).keys()]);
  else return false;
  return true;
}
