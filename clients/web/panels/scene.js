// Scene: what stands around the arm, by numbers; shown in the view before it is saved, and saved as a new version.
import { ApiError, get, resourcePath } from "../api.js";
import { CalibrationGuide } from "../calibration/calibration_guide.js";
import { offerNamed } from "../display_names.js";
import { block, closestData, element, foldedSection, hint, section } from "../elements.js";
import { icon } from "../icons.js";
import { missingSentence } from "../identity.js";
import { patchChildren } from "../patch_children.js";
import { SceneDraft, shapeAt, withShape } from "../scenes/scene_draft.js";
import { SceneFloor } from "../scenes/scene_floor.js";
import { SceneSaving } from "../scenes/scene_saving.js";
import { sceneVersions } from "../scenes/scene_versions.js";
import { ShapeDrag } from "../scenes/shape_drag.js";
import { ShapeFields } from "../scenes/shape_fields.js";
import { ShapeList } from "../scenes/shape_list.js";
import { changesAny } from "../store.js";
import { formatMoment } from "../texts.js";

/** @typedef {import("../scenes/scene_draft.js").Place} Place */

const SCENE_HELP = "What stands around the arm. Every change is shown in the view at once, and holds when it is saved.";
const SERVICE_AWAY_SENTENCE = "The scenes cannot be read yet: the service does not answer.";
const UNCHANGED_SENTENCE = "Nothing was changed since this version.";

/** @type {ScenePanel | null} */
let scenes = null;

/** @type {Panel & {shapeDrag: () => ShapeDrag | undefined}} */
export const panel = {
  id: "scene",
  title: "Scene",
  mount(place, context) {
    scenes = new ScenePanel(place, context);
  },
  update: (state, changed) => scenes?.update(state, changed),
  show: () => scenes?.show(),
  hide: () => scenes?.hide(),
  shapeDrag: () => scenes?.drag,
};

class ScenePanel {
  /** @type {Map<string, SceneDraft>} */
  #drafts = new Map(); // of the scenes that were looked at: what was changed in one waits while another is looked at
  /** @type {SceneDraft | null} */
  #draft = null;
  /** @type {SceneVersion[]} */
  #versions = []; // of its scene, newest first
  /** @type {Place | null} */
  #chosen = null; // shape
  #reads = 0; // so far: only the newest one's answer counts
  #isShown = false;
  #picked = ""; // the scene that a person has chosen; "": that of the task

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.head = headParts(section(place, "scene-choice", "Scene"));
    const scene = () => this.#draft?.scene ?? null;
    const refuse = (/** @type {string} */ sentence) => context.messages.show(sentence, "error");
    const parts = section(place, "scene-parts", "What it is made of");
    this.list = new ShapeList(parts, {
      scene,
      choose: (chosen) => this.#choose(chosen),
      change: (changed, what, chosen) => this.#change(changed, what, chosen),
      tell: (sentence) => context.messages.show(sentence),
      attempt: context.attempt,
    });
    this.floor = new SceneFloor(parts, { scene, change: (all, what) => this.#change(all, what, this.#chosen), refuse });
    /** @param {Shape} shape @param {string} what */
    const change = (shape, what) => {
      if (this.#draft && this.#chosen)
        this.#change(withShape(this.#draft.scene, this.#chosen, shape), what, this.#chosen);
    };
    this.fields = new ShapeFields(section(place, "scene-shape", "The chosen shape"), { scene, change, refuse });
    this.drag = new ShapeDrag(context.overlay, { change, preview: (shape) => this.#preview(shape) });
    this.guide = new CalibrationGuide(foldedSection(place, "calibration", "Calibrate by touch"), context, {
      scene,
      shape: () => this.#draft && shapeAt(this.#draft.scene, this.#chosen),
      changeShape: change,
      changeScene: (moved, what) => this.#change(moved, what, this.#chosen),
    });
    const saving = section(place, "scene-saving", "Save");
    this.versions = foldedSection(place, "scene-versions", "Versions");
    const foot = element("div", { class: "edit-foot" }, this.head.state);
    this.saving = new SceneSaving(saving, foot, context, (name) => this.#pick(name));
    place.append(foot);
    this.saving.name.addEventListener("input", () => this.#render());
    this.#listen();
    this.#render();
  }

  #listen() {
    const { select, undo, redo, revert } = this.head;
    const { attempt, eventStream } = this.context;
    select.addEventListener("change", () => attempt(() => this.#pick(select.value)));
    undo.addEventListener("click", () => this.#step("undo"));
    redo.addEventListener("click", () => this.#step("redo"));
    revert.addEventListener("click", () => {
      this.#draft?.revert();
      this.#choose(null);
    });
    this.versions.addEventListener("click", (event) => {
      const { version } = closestData(event);
      if (version) attempt(() => this.#takeVersion(Number(version)));
    });
    for (const topic of ["scenes", "all"])
      eventStream.on(topic, () => {
        if (this.#isShown) attempt(() => this.#readAgain());
      });
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (!this.#isShown || !changesAny(changed, "task", "tasks", "identity", "trackers")) return;
    if (changed.has("trackers")) this.guide.show();
    if (changed.has("identity")) this.#render();
    if (!this.#picked && sceneOfTask(state) !== this.#draft?.name) this.context.attempt(() => this.#readAgain());
  }

  show() {
    this.#isShown = true;
    this.#render();
    this.context.attempt(() => this.#readAgain());
    this.context.attempt(() => this.guide.readCalibrations());
  }

  hide() {
    this.#isShown = false;
    this.guide.hide();
    this.context.sceneLayers.preview(null, null);
    this.drag.show(null);
  }

  /** Look at a scene, whichever the task is done in. @param {string} name */
  #pick(name) {
    this.#picked = name;
    return this.#read();
  }

  /** Read what nobody has asked for: without the service, what is known of it stays, and it is read when that is back. */
  async #readAgain() {
    await this.#read().catch((error) => {
      if (!(error instanceof ApiError) || error.status !== 0) throw error;
      if (!this.#draft) this.head.state.textContent = SERVICE_AWAY_SENTENCE;
    });
  }

  /** Read which scenes there are, and the one that is looked at; what does not count any more may fail. */
  async #read() {
    const request = ++this.#reads;
    await this.#readAs(request).catch((error) => {
      if (request === this.#reads && !this.saving.isBusy) throw error; // else the scene may just have been removed
    });
  }

  /** What was changed in the scene that is looked at, else its newest version. @param {number} request */
  async #readAs(request) {
    /** @type {Scene[]} */
    const all = await get("scenes");
    const names = all.map(({ name }) => name);
    const wanted = this.#picked || sceneOfTask(this.context.store.state);
    const name = wanted && names.includes(wanted) ? wanted : names[0];
    const place = resourcePath("scenes", name);
    /** @type {[SavedScene, SceneVersion[]]} */
    const [newest, versions] = await Promise.all([get(place), get(`${place}/versions`)]);
    if (request !== this.#reads || this.saving.isBusy) return; // another one is wanted meanwhile, or it is read after that
    const former = this.#drafts.get(name);
    const draft = former?.isEdited || former?.base === newest.version.number ? former : new SceneDraft(newest);
    if (draft !== this.#draft) this.#chosen = null;
    this.#drafts.set(name, draft);
    this.#draft = draft;
    this.#versions = versions;
    offerNamed(this.head.select, all);
    this.head.select.value = name;
    this.#render();
  }

  /** Go on from what a version holds; to save that brings it back. @param {number} number */
  async #takeVersion(number) {
    const draft = this.#draft;
    if (!draft) return;
    /** @type {SavedScene} */
    const { scene } = await get(resourcePath("scenes", draft.name, "versions", number));
    if (draft !== this.#draft) return; // another one is looked at meanwhile
    const what = `taking version ${number}`;
    if (number === this.#versions[0]?.number) draft.rebase({ base: number, original: scene }, what);
    else draft.change(scene, what);
    this.#choose(null);
  }

  /** @param {Place | null} chosen */
  #choose(chosen) {
    this.#chosen = chosen;
    this.#render();
  }

  /** @param {Scene} scene @param {string} what names the step @param {Place | null} chosen */
  #change(scene, what, chosen) {
    this.#draft?.change(scene, what);
    this.context.messages.clear();
    this.#choose(chosen);
  }

  /** @param {"undo" | "redo"} way */
  #step(way) {
    const draft = this.#draft;
    draft?.[way]();
    this.#choose(draft && shapeAt(draft.scene, this.#chosen) ? this.#chosen : null);
  }

  #render() {
    const draft = this.#draft;
    const shape = draft && shapeAt(draft.scene, this.#chosen);
    const { select, state, undo, redo, revert } = this.head;
    state.textContent = draft ? stateText(draft, this.#versions) : "The scene is being read …";
    block(undo, draft?.undoLabel ? "" : "There is no step to undo.", `Undo ${draft?.undoLabel}`);
    block(redo, draft?.redoLabel ? "" : "No step was undone.", `Redo ${draft?.redoLabel}`);
    block(revert, draft?.isEdited ? "" : UNCHANGED_SENTENCE);
    this.list.show(draft?.scene ?? null, this.#chosen);
    this.fields.show(shape, this.#chosen?.part ?? null);
    this.floor.show(draft?.scene ?? null);
    this.guide.show();
    const missing = missingSentence(this.context.store.state.identity, ["teach"]);
    this.saving.show(draft, missing, select.options.length < 2);
    patchChildren(this.versions, sceneVersions(this.#versions, draft?.base ?? 0));
    if (!this.#isShown) return;
    this.context.sceneLayers.preview(draft?.scene ?? null, shape);
    this.drag.show(shape);
  }

  /** Draw the chosen shape as it is while it is dragged. @param {Shape} shape */
  #preview(shape) {
    if (!this.#draft || !this.#chosen) return;
    this.context.sceneLayers.preview(withShape(this.#draft.scene, this.#chosen, shape), shape);
    this.fields.show(shape, this.#chosen?.part ?? null);
  }
}

/** @param {State} state */
const sceneOfTask = ({ tasks, task }) => tasks?.find(({ name }) => name === task)?.scene;

/** @param {SceneDraft} draft @param {SceneVersion[]} versions newest first */
function stateText({ base, isEdited }, versions) {
  const saved = versions.find(({ number }) => number === base);
  const by = saved?.author ? ` by ${saved.author}` : "";
  const when = saved?.created_ns ? `, saved ${formatMoment(saved.created_ns)}${by}` : ", of the settings";
  const newest = versions[0]?.number ?? base;
  const behind =
    newest > base ? ` Version ${newest} was saved meanwhile: take it below, or save under another name.` : "";
  return `${isEdited ? "Changed since version" : "This is version"} ${base}${when}.${behind}`;
}

/** Which scene is looked at, how it stands, and the steps back. @param {HTMLElement} place */
function headParts(place) {
  const select = element("select", { id: "scene-name" });
  const state = element("p", { class: "verdict-line", role: "status", id: "scene-state" });
  /** @param {string} id @param {...Child} children */
  const button = (id, ...children) => element("button", { type: "button", id: `scene-${id}` }, children);
  const [undo, redo] = [button("undo", icon("undo"), "Undo"), button("redo", icon("redo"), "Redo")];
  const revert = button("revert", "Back to the version");
  place.append(
    hint(SCENE_HELP),
    element("p", { class: "field" }, element("label", { for: "scene-name" }, "Scene to change"), select),
    element("p", { class: "buttons" }, undo, redo, revert),
  );
  return { select, state, undo, redo, revert };
}
