// Edit: the chosen path's control points.
import { hint, replace, section } from "../elements.js";
import { pathOf } from "../store.js";

let body;

export const panel = {
  id: "edit",
  title: "Edit",

  mount(place) {
    body = section(place, "edit", "Path");
  },

  update(state, changed) {
    if (!["runs", "run", "path"].some((name) => changed.has(name))) return;
    const path = pathOf(state);
    replace(body, hint(path ? `${path.id}: ${path.curve.control_points.length} control points.` : "Nothing to edit yet. Learn the ways of a task first; each has a path."));
  },
};
