// What plans are of, in words: their task, way and version, read once for all that are listed.
import { get } from "../api.js";
import { taskTitle } from "../display_names.js";

const MAX_ENTRIES = 200; // newest plans and paths that are asked for

export class PlanNames {
  /** @type {Map<string, string>} */
  #names = new Map(); // of a plan by its id; "": the service does not list it any more

  /** The name of a plan; empty while it is not known. @param {string | null} plan */
  of(plan) {
    return (plan && this.#names.get(plan)) ?? "";
  }

  /**
   * Read the names of plans where some are unknown; returns whether any came.
   * @param {string[]} plans
   * @param {Task[] | null} tasks
   */
  async read(plans, tasks) {
    const unknown = plans.filter((plan) => !this.#names.has(plan));
    if (!unknown.length) return false;
    const lists = await Promise.all([get(`plans?limit=${MAX_ENTRIES}`), get(`paths?limit=${MAX_ENTRIES}`)]).catch(
      () => null,
    );
    if (!lists) return false; // asked again with the next change
    const found = planNames(...lists, tasks);
    for (const plan of unknown) this.#names.set(plan, found.get(plan) ?? "");
    return true;
  }
}

/**
 * @param {Pick<PlanSummary, "id" | "task" | "path" | "path_version">[]} plans
 * @param {{id: string, cluster: number}[]} paths
 * @param {Pick<Task, "name" | "display_name">[] | null} tasks
 * @returns {Map<string, string>}
 */
export function planNames(plans, paths, tasks) {
  const clusters = new Map(paths.map(({ id, cluster }) => [id, cluster]));
  return new Map(
    plans.map(({ id, task, path, path_version }) => {
      const way = clusters.has(path) ? `way ${clusters.get(path)}` : "a path";
      return [id, `${taskTitle(tasks, task)}, ${way}, version ${path_version}`];
    }),
  );
}
