// The operator's page: puts the 3-D view, the state and the panels together.
//
// A panel is a module panels/NAME.js that exports `panel`:
//   panel = { id, title,
//             mount(element, context)   called once; element is the panel's own, empty
//             update(state, changed)    called after every change of the state; changed is the Set of names (store.js)
//             show(), hide() }          optional: its tab was chosen, or another one
// context = { store, eventStream, view, sceneLayers, overlay, messages,
//             readOnly                  nothing can be ordered: a review package shows the panel
//             attempt(order)            do an order; an error becomes a sentence in the message line
//             open(id),                 choose another tab
//             armStop }                 stops the arm, and tries until it is confirmed (arm/stop.js)
// A panel reads context.store.state, changes it with context.store.set(), and speaks REST through api.js.
import { administration } from "./administration.js";
import { post } from "./api.js";
import { lease } from "./arm/lease.js";
import { ArmStop } from "./arm/stop.js";
import { closest, closestData, element } from "./elements.js";
import { eventLog } from "./event_log.js";
import { EventStream } from "./event_stream.js";
import { keepFocus } from "./focus_keeper.js";
import { header, stopButton } from "./header.js";
import { panelHelp } from "./help_links.js";
import { IdentityControl, missingSentence } from "./identity.js";
import { Messages } from "./messages.js";
import { newTaskDialog } from "./new_task.js";
import { stepByArrows } from "./number_input.js";
import { panelWidth } from "./panel_width.js";
import { panel as demonstrate } from "./panels/demonstrate.js";
import { panel as edit } from "./panels/edit.js";
import { panel as run } from "./panels/run.js";
import { panel as scene } from "./panels/scene.js";
import { panel as ways } from "./panels/ways.js";
import { enablePathPicking } from "./path_picking.js";
import { SceneLayers } from "./scene_layers.js";
import { stationMenu } from "./stations.js";
import { doneSteps } from "./steps.js";
import { activeExecution, Store } from "./store.js";
import { Tabs } from "./tabs.js";
import { taskMenu } from "./task_menu.js";
import { View } from "./view.js";
import { connectViewControls } from "./view_controls.js";
import { feedView } from "./view_feed.js";

/** What the tabs are for, as capabilities. @type {Record<string, Identity["capabilities"]>} */
const NEEDED_CAPABILITIES = {
  demonstrate: ["demonstrate"],
  ways: ["teach"],
  edit: ["teach"],
  run: ["operate"],
  scene: ["teach"],
};
const TAB_KEY = "tab"; // chosen in this browser tab, through a reload
const STOP_TIMEOUT = 3000; // [ms] of one try: the service says within 2 s that it has no confirmation

const root = document.documentElement;
const store = new Store();
const eventStream = new EventStream(store);
const messages = new Messages(byId("message"));
const view = new View(byId("view"), () => {
  if (sceneLayers.isComplete) root.dataset.scene = "ready";
});
const sceneLayers = new SceneLayers(view, store);
enablePathPicking(view, store, sceneLayers);

/** @param {string} id */
function byId(id) {
  return /** @type {HTMLElement} */ (document.getElementById(id));
}

/** @param {Identity} identity */
function showMissing(identity) {
  for (const [panel, place] of missing) {
    place.textContent = missingSentence(identity, NEEDED_CAPABILITIES[panel.id] ?? []);
    place.hidden = !place.textContent;
  }
}

/** Show the links to what the station has. @param {State["station"]} station */
function showStation(station) {
  byId("trust").hidden = !station?.authority;
  const name = station?.display_name || "teachpath";
  byId("station-name").textContent = name;
  document.title = name === "teachpath" ? name : `${name} – teachpath`;
  for (const link of help) link.hidden = !station?.documents;
}

/**
 * The page is live when both of its WebSockets are; either may come back first.
 * @param {"connection" | "events"} which
 * @param {ConnectionState} state
 * @param {ConnectionDetails} details
 */
function showConnection(which, state, { delay = 0 }) {
  root.dataset[which] = state;
  const states = [root.dataset.connection, root.dataset.events];
  if (state === "lost") identity.check();
  const all = states.includes("lost") ? "lost" : states.includes("connecting") ? "connecting" : "live";
  store.set({ connection: all });
  byId("connection").textContent = {
    live: "Connected",
    connecting: "Connecting to the service …",
    lost: `No connection to the service; trying again in ${Math.max(1, Math.round(delay))} s`,
  }[all];
}

const keptTab = sessionStorage.getItem(TAB_KEY) ?? "";
const tabs = new Tabs(byId("tabs"), byId("panels"), (id) => {
  sessionStorage.setItem(TAB_KEY, id);
  for (const panel of panels) panel[panel.id === id ? "show" : "hide"]?.();
});
const armStop = new ArmStop((path) => post(path, {}, lease.headers, STOP_TIMEOUT));
/** @type {Context} */
const context = {
  store,
  eventStream,
  view,
  sceneLayers,
  overlay: view.overlay,
  messages,
  readOnly: false,
  attempt: (order) => messages.attempt(order),
  open: (id) => tabs.select(id),
  armStop,
};
/** @type {Panel[]} */
const panels = [demonstrate, ways, edit, run, scene];
/** @type {Map<Panel, HTMLElement>} what somebody may not do in a panel */
const missing = new Map();
const help = [byId("help")]; // links to the documents
for (const panel of panels) {
  const place = tabs.add(panel.id, panel.title);
  const sentence = element("p", { class: "hint missing", hidden: "" });
  missing.set(panel, sentence);
  const links = panelHelp(panel.id);
  help.push(links);
  place.append(sentence, links);
  panel.mount(place, context);
}
newTaskDialog(byId("new-task"), context);
taskMenu(byId("task-menu"), context);
administration(byId("access"), byId("access-button"), context);
eventLog(byId("events"), byId("events-button"), store);
const taskSelect = /** @type {HTMLSelectElement} */ (byId("task"));
const stop = /** @type {HTMLButtonElement} */ (byId("stop"));
header(context, { task: taskSelect, control: byId("control"), arm: byId("arm-state") });
stationMenu(store, /** @type {HTMLSelectElement} */ (byId("station")));
stopButton(context, armStop, { stop, warning: byId("not-stopped") });
const identity = new IdentityControl(context, { who: byId("identity"), signIn: byId("sign-in") });
let mayMove = false; // also while an executor is silent that moved the arm
store.subscribe((state, changed) => {
  if (state.executor) mayMove = activeExecution(state) !== null;
  if (changed.has("identity")) showMissing(state.identity);
  if (changed.has("station")) showStation(state.station);
  for (const panel of panels) panel.update(state, changed);
  tabs.setDone(doneSteps(state));
  sceneLayers.update(state, changed);
});
for (const topic of ["scenes", "all"]) eventStream.on(topic, () => sceneLayers.reread());
for (const panel of panels) panel.update(store.state, new Set(Object.keys(store.state)));
tabs.select(keptTab);

byId("panels").addEventListener("click", (event) => {
  const { open } = closestData(event, "[data-open]");
  if (open) tabs.select(open);
});
connectViewControls(view, store);
panelWidth(/** @type {HTMLElement} */ (byId("panels").parentElement));
keepFocus();
stepByArrows(byId("panels"));
// The space bar stops the arm wherever the focus is, but in a text field.
addEventListener(
  "keydown",
  (event) => {
    const isTyped = closest(event, "input[type=text], input[type=number], input[type=password], textarea");
    if (event.code !== "Space" || isTyped || !mayMove) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) armStop.request();
  },
  { capture: true },
);

// Whoever has not signed in hears nothing: the WebSockets are opened then.
identity.whenSeeing(() => {
  eventStream.start((state, details) => showConnection("events", state, details));
  feedView(view, (state, details) => showConnection("connection", state, details));
});

// What the browser tests may ask: the state, whether all of the task is drawn, whether the camera stays where it is, paths
// drawn, where they are, the height of the arm's stand [m], how often the view was drawn.
Object.assign(globalThis, {
  teachpath: {
    state: () => store.state,
    settled: () => sceneLayers.isComplete,
    framed: () => view.isFramed,
    objectPaths: () => view.objectPaths(),
    worldMatrix: (/** @type {string} */ path) => view.worldMatrix(path),
    opacity: (/** @type {string} */ path) => view.opacity(path),
    project: view.overlay.project.bind(view.overlay),
    unproject: view.overlay.unproject.bind(view.overlay),
    previewGhost: () => run.previewGhost(),
    replayGhost: () => run.replayGhost(),
    teleop: () => run.teleop(),
    headset: () => demonstrate.headset() ?? run.headset(),
    session: () => demonstrate.session(),
    get editor() {
      return edit.editor;
    },
    shapeDrag: () => scene.shapeDrag(),
    stand: () => (view.environment.stand.visible ? view.environment.stand.scale.z : 0),
    get draws() {
      return view.draws;
    },
  },
});
