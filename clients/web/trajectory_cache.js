// The trajectories of demonstrations, read once and kept: as many points as are drawn.
import { get, resourcePath } from "./api.js";

const POINTS = 150; // of a demonstration as drawn
const DECIMALS = 4; // of a metre: 0.1 mm
const MAX_REQUESTS = 4; // at a time
const NOTICE_INTERVAL = 100; // [ms] between two notices that more are here: each draws lists and view anew

export class TrajectoryCache {
  /** @type {Map<string, {trim: string, points: Point[]}>} */
  #trajectories = new Map();
  /** @type {Set<string>} */
  #requested = new Set();
  /** @type {Set<string>} */
  #unnoticed = new Set(); // that have come since the last notice

  /** @param {() => void} onLoad called when further trajectories are here */
  constructor(onLoad) {
    this.onLoad = onLoad;
  }

  /** Whether nothing that was asked for is still to come. */
  get isComplete() {
    return !this.#requested.size;
  }

  /**
   * Points of a demonstration, or null while they are not here yet, or cannot be drawn.
   * @param {string} id
   */
  get(id) {
    const points = this.#trajectories.get(id)?.points;
    return points && points.length > 1 ? points : null;
  }

  /**
   * Ask for the trajectories that are not here yet, or whose trim has changed; newest first.
   * @param {Demonstration[]} demonstrations
   */
  async request(demonstrations) {
    const missing = demonstrations
      .filter((d) => this.#trajectories.get(d.id)?.trim !== trimKey(d) && !this.#requested.has(d.id))
      .reverse();
    for (const { id } of missing) this.#requested.add(id);
    const next = async () => {
      for (let d = missing.shift(); d; d = missing.shift()) await this.#load(d);
    };
    await Promise.all(Array.from({ length: MAX_REQUESTS }, next));
  }

  #notice() {
    for (const id of this.#unnoticed) this.#requested.delete(id);
    this.#unnoticed.clear();
    this.onLoad();
  }

  /** @param {Demonstration} demonstration */
  async #load(demonstration) {
    const { id } = demonstration;
    const read = get(`${resourcePath("demonstrations", id, "trajectory")}?most=${POINTS}&decimals=${DECIMALS}`);
    const points = await read.then(
      ({ positions }) => positions,
      () => [], // a recording that cannot be read has no trajectory; its verdict says why
    );
    this.#trajectories.set(id, { trim: trimKey(demonstration), points });
    if (!this.#unnoticed.size) setTimeout(() => this.#notice(), NOTICE_INTERVAL);
    this.#unnoticed.add(id);
  }
}

/**
 * Where a demonstration is cut from its recording: another trim has another trajectory.
 * @param {Demonstration} demonstration
 */
export const trimKey = ({ trim, grasp, release }) => (trim ?? [grasp, release]).join();
