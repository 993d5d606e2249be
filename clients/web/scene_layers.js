// Draws the chosen task in the 3-D view: its scene, demonstrations, learned paths, deviations and spread.
// Names in the view's tree: /scene/NAME, /demonstrations/ID, /paths/ID, /deviations/ID (of a demonstration), /spread/ID
// (of a path); panels may draw beside them on the overlay.
import { get, resourcePath } from "./api.js";
import { demonstrationLine, deviationTube, highlightTube, pathTube, shapeMesh, spreadTube } from "./meshes.js";
import { latestPaths, selectedRun } from "./store.js";

const POINTS_PER_TRAJECTORY = 150; // of a demonstration as drawn
const MAX_REQUESTS = 4; // trajectories that are asked for at a time
const MAX_DEMONSTRATIONS = 200; // newest demonstrations

export class SceneLayers {
  #trajectories = new Map(); // demonstration -> {trim, points}
  #requested = new Set();
  #scenes = null;
  #drawn = new Map(); // name in the tree -> what it shows, so that only what differs is drawn again

  constructor(view, store) {
    Object.assign(this, { view, store });
  }

  // Points [[x, y, z]] of a demonstration [m], or null while they are not here yet.
  trajectory(demonstration) {
    return this.#trajectories.get(demonstration)?.points ?? null;
  }

  // The trajectories that are drawn now: [[demonstration, points], ...].
  drawnTrajectories() {
    return [...this.#trajectories]
      .filter(([id]) => this.#drawn.has(`demonstrations/${id}`))
      .map(([id, trajectory]) => [id, trajectory.points]);
  }

  // Whether everything that is to be drawn is drawn.
  get isComplete() {
    const { tasks, task, demonstrations, runs } = this.store.state;
    return tasks !== null && (!task || (this.#scenes && demonstrations && runs && !this.#requested.size));
  }

  update(state, changed) {
    if (changed.has("tasks") || changed.has("task")) this.#showScene();
    if (
      ["demonstrations", "runs", "run", "latestVersions", "task", "trajectoriesLoaded"].some((name) =>
        changed.has(name),
      )
    )
      this.#showTask(state);
    if (changed.has("focus") || changed.has("path") || changed.has("runs")) this.#highlight(state);
  }

  async #showScene() {
    try {
      this.#scenes ??= await get("scenes");
    } catch {
      return; // asked again with the next change of the tasks
    }
    const { state } = this.store; // another task may have been chosen meanwhile
    const name = state.tasks?.find((task) => task.name === state.task)?.scene;
    const scene = this.#scenes.find((other) => other.name === name) ?? this.#scenes[0];
    this.#sync(
      "scene",
      new Map(scene.obstacles.map((shape) => [shape.name, [JSON.stringify(shape), () => shapeMesh(shape)]])),
    );
  }

  #showTask(state) {
    const kept = (state.demonstrations ?? []).filter((d) => !d.discarded_ns).slice(-MAX_DEMONSTRATIONS);
    this.#fetch(kept);
    const run = selectedRun(state)?.learned;
    const ways = new Map((run?.clusters ?? []).flatMap((cluster) => cluster.members.map((id) => [id, cluster.index])));
    const trajectories = kept.filter((d) => this.trajectory(d.id)?.length > 1);
    this.#sync(
      "demonstrations",
      new Map(
        trajectories.map((d) => [
          d.id,
          [`${trimKey(d)} ${ways.get(d.id)}`, () => demonstrationLine(this.trajectory(d.id), ways.get(d.id))],
        ]),
      ),
    );
    const deviating = (run?.clusters ?? [])
      .flatMap((cluster) => cluster.scores)
      .filter((score) => score.deviation && trajectories.some((d) => d.id === score.demonstration));
    this.#sync(
      "deviations",
      new Map(
        deviating.map((score) => [
          score.demonstration,
          [
            JSON.stringify(score.deviation.share),
            () => deviationTube(this.trajectory(score.demonstration), score.deviation.share),
          ],
        ]),
      ),
    );
    const paths = latestPaths(state);
    this.#sync("paths", new Map(paths.map((path) => [path.id, [`${path.version}`, () => pathTube(path)]])));
    const spread = new Map((run?.clusters ?? []).map((cluster) => [cluster.index, cluster.spread]));
    const tubes = paths.filter((path) => spread.get(path.cluster)?.length > 1);
    this.#sync(
      "spread",
      new Map(tubes.map((path) => [path.id, [`${path.version}`, () => spreadTube(path, spread.get(path.cluster))]])),
    );
    this.#highlight(state);
    this.view.refresh();
  }

  // Draw what is new or different in a part of the tree and take away what is gone.
  #sync(part, wanted) {
    const viewer = this.view.viewer;
    for (const name of [...this.#drawn.keys()].filter((key) => key.startsWith(`${part}/`))) {
      const id = name.slice(part.length + 1);
      if (wanted.has(id)) continue;
      viewer.delete_path([part, id]);
      this.#drawn.delete(name);
    }
    for (const [id, [key, make]] of wanted) {
      if (this.#drawn.get(`${part}/${id}`) === key) continue;
      viewer.set_object([part, id], make());
      this.#drawn.set(`${part}/${id}`, key);
    }
    this.view.refresh();
  }

  // Ask for the trajectories that are not here yet, or whose trim has changed; newest first.
  async #fetch(demonstrations) {
    const missing = demonstrations
      .filter((d) => this.#trajectories.get(d.id)?.trim !== trimKey(d) && !this.#requested.has(d.id))
      .reverse();
    for (const d of missing) this.#requested.add(d.id);
    const next = async () => {
      for (let d = missing.shift(); d; d = missing.shift()) {
        const points = await get(
          `${resourcePath("demonstrations", d.id, "trajectory")}?most=${POINTS_PER_TRAJECTORY}`,
        ).then(
          (trajectory) => trajectory.positions,
          () => [], // a recording that cannot be read has no trajectory; its verdict says why
        );
        this.#trajectories.set(d.id, { trim: trimKey(d), points });
        this.#requested.delete(d.id);
        this.store.set({ trajectoriesLoaded: this.store.state.trajectoriesLoaded + 1 });
      }
    };
    await Promise.all(Array.from({ length: MAX_REQUESTS }, next));
  }

  // The focus, and with it what belongs to it, is drawn in full, the rest pale.
  #highlight(state) {
    const { focus } = state;
    const run = selectedRun(state)?.learned;
    const cluster =
      focus &&
      run?.clusters.find((c) =>
        focus.kind === "demonstrations"
          ? c.members.includes(focus.id)
          : run.paths.some((p) => p.id === focus.id && p.cluster === c.index),
      );
    const names = focus && [`${focus.kind}/${focus.id}`];
    if (focus?.kind === "demonstrations") names.push(`deviations/${focus.id}`);
    if (focus?.kind === "paths" && cluster)
      names.push(...cluster.members.map((id) => `demonstrations/${id}`), `spread/${focus.id}`);
    if (focus?.kind === "demonstrations" && cluster)
      names.push(...run.paths.filter((p) => p.cluster === cluster.index).map((p) => `paths/${p.id}`));
    this.view.highlighted = names && new Set(names);
    const trajectory = focus?.kind === "demonstrations" && this.trajectory(focus.id);
    this.#sync(
      "focus",
      trajectory?.length > 1 ? new Map([[focus.id, ["", () => highlightTube(trajectory, cluster?.index)]]]) : new Map(),
    );
  }
}

// Where a demonstration is cut from its recording: another trim has another trajectory.
const trimKey = (d) => (d.trim ?? [d.grasp, d.release]).join();
