// A new task: its name and the scene that it is done in, in a popover of the header.
import { get, put, resourcePath } from "./api.js";
import { displayNameOf, idOf, nameField, offerNamed } from "./display_names.js";
import { element, hint } from "./elements.js";

/** @param {HTMLElement} place @param {Context} context */
export function newTaskDialog(place, { store, eventStream, attempt, open }) {
  const name = element("input", { type: "text", id: "new-name", required: "", autocomplete: "off" });
  const id = element("p", { class: "note" });
  const showId = nameField(name, id);
  const scene = element("select", { id: "new-scene" });
  const anywhere = element("input", { type: "checkbox", id: "new-object-at-grasp" });
  const form = element(
    "form",
    {},
    element("h2", {}, "New task"),
    hint(
      "What is shown from now on for another purpose is learned on its own. The scene says what stands around the arm.",
    ),
    element("p", { class: "field" }, element("label", { for: "new-name" }, "Name"), name),
    id,
    element("p", { class: "field" }, element("label", { for: "new-scene" }, "Scene"), scene),
    element("p", { class: "field" }, element("label", {}, anywhere, " The object lies elsewhere each time")),
    hint("Each demonstration then begins where the hand grasps it, not where the scene has it."),
    element("p", { class: "buttons" }, element("button", { type: "submit", class: "primary" }, "Make the task")),
  );
  place.append(form);
  let chosen = ""; // by the person, since the popover was opened; whatever comes later leaves it
  /** @param {Scene[]} scenes */
  const offer = (scenes) => {
    const used = store.state.tasks?.find((task) => task.name === store.state.task)?.scene;
    offerNamed(scene, scenes);
    scene.value = [chosen, used].find((one) => scenes.some((other) => other.name === one)) ?? scenes[0]?.name ?? "";
  };
  scene.addEventListener("change", () => {
    chosen = scene.value;
  });
  // The toggle comes only after a while, when a person may have chosen already.
  place.addEventListener("beforetoggle", () => {
    chosen = "";
  });
  place.addEventListener("toggle", async (event) => {
    if (!(event instanceof ToggleEvent) || event.newState !== "open") return;
    name.focus();
    const scenes = await attempt(() => get("scenes"));
    if (scenes) offer(scenes);
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    attempt(make);
  });

  async function make() {
    const called = name.value.trim();
    const wanted = idOf(called);
    if (store.state.tasks?.some((task) => task.name === wanted))
      throw new Error(`There is a task ${wanted} already: choose it above, or give another name.`);
    const made = { scene: scene.value, object_at_grasp: anywhere.checked, display_name: displayNameOf(called) };
    await put(resourcePath("tasks", wanted), made);
    await eventStream.read("tasks");
    if (name.value.trim() !== called) return; // another one is named meanwhile
    name.value = "";
    showId();
    anywhere.checked = false;
    if (!place.matches(":popover-open")) return; // it was left meanwhile
    store.set({ task: wanted });
    place.hidePopover();
    open("demonstrate");
  }
}
