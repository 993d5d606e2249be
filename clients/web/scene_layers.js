// What the 3-D view shows of the chosen task: its scene, demonstrations, ways, departures and tubes.
// Names in the view's tree: /scene/NAME, /demonstrations/ID, /paths/ID, /departures/ID (of a demonstration), /spread/ID
// (of a path); panels may draw beside them on the easel.
import { at, get } from "./api.js";
import { departure, line, marked, solid, spreadTube, way } from "./meshes.js";
import { pathsOf, runOf } from "./store.js";

const POINTS = 150; // of a demonstration as drawn
const AT_ONCE = 4; // trajectories that are asked for at a time
const DRAWN = 200; // newest demonstrations

export class Gallery {
  #courses = new Map(); // demonstration -> {cut, points}
  #waiting = new Set();
  #scenes = null;
  #drawn = new Map(); // name in the tree -> what it shows, so that only what differs is drawn again

  constructor(view, store) {
    Object.assign(this, { view, store });
  }

  // Points [[x, y, z]] of a demonstration [m], or null while they are not here yet.
  course(demonstration) {
    return this.#courses.get(demonstration)?.points ?? null;
  }

  // The courses that are drawn now: [[demonstration, points], ...].
  drawn() {
    return [...this.#courses].filter(([id]) => this.#drawn.has(`demonstrations/${id}`)).map(([id, course]) => [id, course.points]);
  }

  // Whether everything that is to be shown is shown.
  get settled() {
    const { tasks, task, demonstrations, runs } = this.store.state;
    return tasks !== null && (!task || (this.#scenes && demonstrations && runs && !this.#waiting.size));
  }

  update(state, changed) {
    if (changed.has("tasks") || changed.has("task")) this.#showScene();
    if (["demonstrations", "runs", "run", "newest", "task", "courses"].some((name) => changed.has(name))) this.#showTask(state);
    if (changed.has("focus") || changed.has("path") || changed.has("runs")) this.#emphasize(state);
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
    this.#keep("scene", new Map(scene.obstacles.map((shape) => [shape.name, [JSON.stringify(shape), () => solid(shape)]])));
  }

  #showTask(state) {
    const kept = (state.demonstrations ?? []).filter((d) => !d.discarded_ns).slice(-DRAWN);
    this.#fetch(kept);
    const run = runOf(state)?.learned;
    const ways = new Map((run?.clusters ?? []).flatMap((cluster) => cluster.members.map((id) => [id, cluster.index])));
    const courses = kept.filter((d) => this.course(d.id)?.length > 1);
    this.#keep("demonstrations", new Map(courses.map((d) => [d.id, [`${cut(d)} ${ways.get(d.id)}`, () => line(this.course(d.id), ways.get(d.id))]])));
    const departed = (run?.clusters ?? []).flatMap((cluster) => cluster.scores).filter((score) => score.deviation && courses.some((d) => d.id === score.demonstration));
    this.#keep("departures", new Map(departed.map((score) => [score.demonstration, [JSON.stringify(score.deviation.share), () => departure(this.course(score.demonstration), score.deviation.share)]])));
    const paths = pathsOf(state);
    this.#keep("paths", new Map(paths.map((path) => [path.id, [`${path.version}`, () => way(path)]])));
    const spread = new Map((run?.clusters ?? []).map((cluster) => [cluster.index, cluster.spread]));
    const tubes = paths.filter((path) => spread.get(path.cluster)?.length > 1);
    this.#keep("spread", new Map(tubes.map((path) => [path.id, [`${path.version}`, () => spreadTube(path, spread.get(path.cluster))]])));
    this.#emphasize(state);
    this.view.refresh();
  }

  // Draw what is new or different in a part of the tree and take away what is gone.
  #keep(part, wanted) {
    const viewer = this.view.viewer;
    for (const name of [...this.#drawn.keys()].filter((key) => key.startsWith(`${part}/`))) {
      const id = name.slice(part.length + 1);
      if (wanted.has(id)) continue;
      viewer.delete_path([part, id]);
      this.#drawn.delete(name);
    }
    for (const [id, [looks, make]] of wanted) {
      if (this.#drawn.get(`${part}/${id}`) === looks) continue;
      viewer.set_object([part, id], make());
      this.#drawn.set(`${part}/${id}`, looks);
    }
    this.view.refresh();
  }

  // Ask for the courses that are not here yet, or whose cut has changed; newest first.
  async #fetch(demonstrations) {
    const missing = demonstrations.filter((d) => this.#courses.get(d.id)?.cut !== cut(d) && !this.#waiting.has(d.id)).reverse();
    for (const d of missing) this.#waiting.add(d.id);
    const next = async () => {
      for (let d = missing.shift(); d; d = missing.shift()) {
        const points = await get(`${at("demonstrations", d.id, "trajectory")}?most=${POINTS}`).then(
          (trajectory) => trajectory.positions,
          () => [], // a recording that cannot be read has no course; its verdict says why
        );
        this.#courses.set(d.id, { cut: cut(d), points });
        this.#waiting.delete(d.id);
        this.store.set({ courses: this.store.state.courses + 1 });
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, next));
  }

  // The focus, and with it what belongs to it, is drawn in full, the rest pale.
  #emphasize(state) {
    const { focus } = state;
    const run = runOf(state)?.learned;
    const cluster = focus && run?.clusters.find((c) => (focus.kind === "demonstrations" ? c.members.includes(focus.id) : run.paths.some((p) => p.id === focus.id && p.cluster === c.index)));
    const names = focus && [`${focus.kind}/${focus.id}`];
    if (focus?.kind === "demonstrations") names.push(`departures/${focus.id}`);
    if (focus?.kind === "paths" && cluster) names.push(...cluster.members.map((id) => `demonstrations/${id}`), `spread/${focus.id}`);
    if (focus?.kind === "demonstrations" && cluster) names.push(...run.paths.filter((p) => p.cluster === cluster.index).map((p) => `paths/${p.id}`));
    this.view.vivid = names && new Set(names);
    const course = focus?.kind === "demonstrations" && this.course(focus.id);
    this.#keep("focus", course?.length > 1 ? new Map([[focus.id, ["", () => marked(course, cluster?.index)]]]) : new Map());
  }
}

// Where a demonstration is cut from its recording: another cut has another course.
const cut = (d) => (d.trim ?? [d.grasp, d.release]).join();
