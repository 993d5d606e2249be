// The review package: the operator's view and panels, reading an archive instead of the service.
import { post } from "../api.js";
import { ArmStop } from "../arm/stop.js";
import { closestData } from "../elements.js";
import { EventStream } from "../event_stream.js";
import { keepFocus } from "../focus_keeper.js";
import { Messages } from "../messages.js";
import { demonstrationList } from "../panels/demonstration_list.js";
import { planPreview } from "../panels/plan_preview.js";
import { sectionedPanel } from "../panels/sectioned_panel.js";
import { panel as ways } from "../panels/ways.js";
import { enablePathPicking } from "../path_picking.js";
import { SceneLayers } from "../scene_layers.js";
import { Store } from "../store.js";
import { Tabs } from "../tabs.js";
import { View } from "../view.js";
import { connectViewControls } from "../view_controls.js";
import { certificate } from "./certificate.js";
import { provenance } from "./provenance.js";

const motion = sectionedPanel("run", "Motion", [
  ["preview", "Preview", planPreview],
  ["certificate", "What it is certified for", certificate],
]);
const demonstrations = sectionedPanel("demonstrations", "Demonstrations", [
  ["task", "Demonstrations", demonstrationList],
]);
const origin = sectionedPanel("origin", "Origin", [["provenance", "Made with", provenance]]);
const panels = [ways, motion, demonstrations, origin];

/** @param {string} id */
const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

const store = new Store();
const eventStream = new EventStream(store);
const messages = new Messages(byId("message"));
const view = new View(byId("view"), () => {
  if (sceneLayers.isComplete) document.documentElement.dataset.report = "ready";
});
const sceneLayers = new SceneLayers(view, store);
const tabs = new Tabs(byId("tabs"), byId("panels"), (id) => {
  for (const panel of panels) panel[panel.id === id ? "show" : "hide"]?.();
});
/** @type {Context} */
const context = {
  store,
  eventStream,
  view,
  sceneLayers,
  overlay: view.overlay,
  messages,
  readOnly: true,
  armStop: new ArmStop((path) => post(path)), // no panel of a package offers it, and the archive refuses it
  attempt: (order) => messages.attempt(order),
  open: (id) => tabs.select(id),
};
for (const panel of panels) panel.mount(tabs.add(panel.id, panel.title), context);
store.subscribe((state, changed) => {
  for (const panel of panels) panel.update(state, changed);
  sceneLayers.update(state, changed);
});
byId("panels").addEventListener("click", (event) => {
  const { open } = closestData(event, "[data-open]");
  if (open) tabs.select(open);
});
enablePathPicking(view, store, sceneLayers);
connectViewControls(view, store);
keepFocus();
const arm = Uint8Array.from(atob(byId("arm").textContent ?? ""), (letter) => letter.charCodeAt(0));
view.draw(arm.buffer);
eventStream.readAll();

// What the browser tests may ask.
Object.assign(globalThis, { teachpath: { state: () => store.state, objectPaths: () => view.objectPaths() } });
