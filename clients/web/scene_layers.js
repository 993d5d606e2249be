// Draws the chosen task in the 3-D view: its scene, demonstrations, learned paths, deviations and spread.
// Names in the view's tree: /scene/NAME, /zones/NAME, while a scene is edited /scene-object/object and /scene-chosen/shape, /demonstrations/ID, /paths/ID, /deviations/ID (of a demonstration), and of a path
// also /marks/ID, /names/ID, /spread/ID; panels may draw beside them on the overlay.
import { get, isPassing, RETRY_DELAY } from "./api.js";
import {
  chosenEdges,
  demonstrationLine,
  deviationTube,
  highlightTube,
  keepInEdges,
  keepOutMesh,
  pathTube,
  shapeMesh,
  spreadTube,
} from "./meshes.js";
import { pathMarks, pathName } from "./path_marks.js";
import { changesAny, latestPaths, selectedPath, waysOfDemonstrations } from "./store.js";
import { TrajectoryCache, trimKey } from "./trajectory_cache.js";

const MAX_DEMONSTRATIONS = 200; // newest demonstrations

/** @typedef {[id: string, key: string, create: () => THREE.Object3D]} Drawing `key`: what it shows; another is drawn anew */

export class SceneLayers {
  /** @type {Scene[] | null} */
  #scenes = null;
  #reading = {}; // the newest reading of the scenes
  /** @type {Map<string, string>} */
  #drawn = new Map(); // name in the tree -> key
  /** @type {Scene | null} */
  #preview = null; // a scene that is edited, drawn instead of the task's

  /** @param {import("./view.js").View} view @param {import("./store.js").Store} store */
  constructor(view, store) {
    this.view = view;
    this.store = store;
    this.trajectories = new TrajectoryCache(() =>
      store.set({ trajectoriesLoaded: store.state.trajectoriesLoaded + 1 }),
    );
  }

  /**
   * The trajectories that are drawn now: [[demonstration, points], ...].
   * @returns {[string, Point[]][]}
   */
  drawnTrajectories() {
    const shown = (this.store.state.demonstrations ?? []).filter(({ id }) => this.#drawn.has(`demonstrations/${id}`));
    return shown.flatMap(({ id }) => {
      const points = this.trajectories.get(id);
      return points ? [/** @type {[string, Point[]]} */ ([id, points])] : [];
    });
  }

  /** Whether everything that is to be drawn is drawn. */
  get isComplete() {
    const { tasks, task, demonstrations, runs } = this.store.state;
    return tasks !== null && (!task || (this.#scenes && demonstrations && runs && this.trajectories.isComplete));
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (changesAny(changed, "tasks", "task")) this.#showScene();
    if (changesAny(changed, "demonstrations", "runs", "selectedRun", "latestVersions", "task", "trajectoriesLoaded")) {
      this.#showTask(state);
    }
    if (changesAny(changed, "focus", "path", "runs")) this.#highlight(state);
  }

  /**
   * Draw a scene that is edited instead of the task's, with what of it is chosen; null: the task's again.
   * @param {Scene | null} scene
   * @param {Shape | null} chosen
   */
  preview(scene, chosen) {
    if (!scene && !this.#preview) return;
    this.#preview = scene;
    const { carried = null } = scene ?? {};
    this.#sync("scene-object", carried ? [["object", JSON.stringify(carried), () => shapeMesh(carried, 0.6)]] : []);
    this.#sync("scene-chosen", chosen ? [["shape", JSON.stringify(chosen), () => chosenEdges(chosen)]] : []);
    this.#showScene();
  }

  /** Read the scenes anew, because one was changed; before the tasks are known, nothing has been drawn of them. */
  async reread() {
    if (this.store.state.tasks === null) return;
    const reading = {};
    this.#reading = reading;
    const scenes = /** @type {Scene[] | null} */ (await get("scenes").catch(() => null)); // null: asked again
    if (this.#reading !== reading) return;
    this.#scenes = scenes;
    this.#showScene();
  }

  async #showScene() {
    try {
      this.#scenes ??= /** @type {Scene[]} */ (await get("scenes"));
    } catch (error) {
      if (isPassing(error)) setTimeout(() => this.#showScene(), RETRY_DELAY);
      return;
    }
    const { state } = this.store; // another task may have been chosen meanwhile
    const name = state.tasks?.find((task) => task.name === state.task)?.scene;
    const scene = this.#preview ?? this.#scenes.find((other) => other.name === name) ?? this.#scenes[0];
    this.#sync(
      "scene",
      scene.obstacles.map((shape) => [shape.name, JSON.stringify(shape), () => shapeMesh(shape)]),
    );
    this.#sync("zones", [
      ...scene.keep_in.map((zone) => drawing(zone.name, `in ${JSON.stringify(zone)}`, () => keepInEdges(zone))),
      ...scene.keep_out.map((zone) => drawing(zone.name, `out ${JSON.stringify(zone)}`, () => keepOutMesh(zone))),
    ]);
    this.view.environment.setFloor(scene.floor);
  }

  /** @param {State} state */
  #showTask(state) {
    const kept = (state.demonstrations ?? []).filter((d) => !d.discarded_ns).slice(-MAX_DEMONSTRATIONS);
    this.trajectories.request(kept);
    const clusters = state.selectedRun?.learned.clusters ?? [];
    this.#sync("demonstrations", this.#demonstrations(kept, waysOfDemonstrations(state)));
    this.#sync("deviations", this.#deviations(clusters, kept));
    const paths = latestPaths(state);
    this.#sync(
      "paths",
      paths.map((path) => [path.id, `${path.version}`, () => pathTube(path)]),
    );
    this.#sync(
      "marks",
      paths.map((path) => [path.id, `${path.version}`, () => pathMarks(path)]),
    );
    this.#sync(
      "names",
      paths.map((path) => [path.id, `${path.version}`, () => pathName(path)]),
    );
    this.#sync("spread", spreads(paths, clusters));
    this.#highlight(state);
    this.view.refresh();
  }

  /**
   * @param {Demonstration[]} demonstrations
   * @param {Map<string, number>} ways
   * @returns {Drawing[]}
   */
  #demonstrations(demonstrations, ways) {
    return demonstrations.flatMap((d) => {
      const [points, way] = [this.trajectories.get(d.id), ways.get(d.id)];
      return points ? [drawing(d.id, `${trimKey(d)} ${way}`, () => demonstrationLine(points, way))] : [];
    });
  }

  /**
   * @param {Cluster[]} clusters
   * @param {Demonstration[]} demonstrations
   * @returns {Drawing[]}
   */
  #deviations(clusters, demonstrations) {
    const kept = new Set(demonstrations.map(({ id }) => id));
    const scores = clusters.flatMap((cluster) => cluster.scores).filter((score) => kept.has(score.demonstration));
    return scores.flatMap(({ demonstration, deviation }) => {
      const points = this.trajectories.get(demonstration);
      if (!deviation || !points) return [];
      return [drawing(demonstration, JSON.stringify(deviation.share), () => deviationTube(points, deviation.share))];
    });
  }

  /**
   * Draw what is new or different in a part of the tree and take away what is gone.
   * @param {string} part
   * @param {Drawing[]} drawings
   */
  #sync(part, drawings) {
    const { viewer } = this.view;
    const wanted = new Set(drawings.map(([id]) => `${part}/${id}`));
    for (const name of [...this.#drawn.keys()]) {
      if (!name.startsWith(`${part}/`) || wanted.has(name)) continue;
      viewer.delete_path([part, name.slice(part.length + 1)]);
      this.#drawn.delete(name);
    }
    for (const [id, key, create] of drawings) {
      if (this.#drawn.get(`${part}/${id}`) === key) continue;
      viewer.set_object([part, id], create());
      this.#drawn.set(`${part}/${id}`, key);
    }
    this.view.refresh();
  }

  /**
   * Draw the focus, and with it what belongs to it, in full, the rest pale.
   * @param {State} state
   */
  #highlight(state) {
    const { focus } = state;
    this.view.standOut(selectedPath(state)?.id ?? "");
    this.view.highlight(focus && new Set(focusNames(state, focus)));
    const points = focus?.kind === "demonstrations" ? this.trajectories.get(focus.id) : null;
    const way = focus ? waysOfDemonstrations(state).get(focus.id) : undefined;
    this.#sync("focus", focus && points ? [[focus.id, "", () => highlightTube(points, way)]] : []);
  }
}

/** @returns {Drawing} @param {string} id @param {string} key @param {() => THREE.Object3D} create */
const drawing = (id, key, create) => [id, key, create];

/**
 * @param {LearnedPath[]} paths
 * @param {Cluster[]} clusters
 * @returns {Drawing[]}
 */
function spreads(paths, clusters) {
  return paths.flatMap((path) => {
    const spread = clusters.find(({ index }) => index === path.cluster)?.spread ?? [];
    return spread.length > 1 ? [drawing(path.id, `${path.version}`, () => spreadTube(path, spread))] : [];
  });
}

/**
 * Names in the tree of the focus and of what belongs to it: the way of a demonstration, the demonstrations of a way.
 * @param {State} state
 * @param {Focus} focus
 */
function focusNames(state, { kind, id }) {
  const { clusters = [], paths = [] } = state.selectedRun?.learned ?? {};
  if (kind === "paths") {
    const way = paths.find((path) => path.id === id)?.cluster;
    const members = clusters.find(({ index }) => index === way)?.members ?? [];
    return [`paths/${id}`, `spread/${id}`, ...members.map((member) => `demonstrations/${member}`)];
  }
  const way = waysOfDemonstrations(state).get(id);
  const own = paths.filter(({ cluster }) => cluster === way).map((path) => `paths/${path.id}`);
  return [`${kind}/${id}`, `deviations/${id}`, ...own];
}
