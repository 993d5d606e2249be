// What lies before each path: duration, clearance and reach, from its newest plan.
import { at, get } from "../api.js";
import { number, percent } from "../elements.js";
import { pathsOf } from "../store.js";

export class Prospects {
  #known = new Map(); // plan -> what it says
  #asking = new Set();

  constructor(store) {
    this.store = store;
  }

  look(state) {
    const found = {};
    for (const path of pathsOf(state)) {
      const jobs = (state.jobs ?? []).filter((job) => job.kind === "plan" && job.request.path === path.id && (job.request.version ?? path.version) === path.version);
      const last = jobs.at(-1);
      const planning = ["queued", "running"].includes(last?.state);
      const plan = last?.state === "succeeded" ? last.outcome : "";
      if (plan && !this.#known.has(plan)) this.#ask(plan);
      const refused = last?.state === "failed" ? { fault: `Not certified: ${last.message}` } : {};
      found[path.id] = { ...this.#known.get(plan), ...refused, planning, planned: Boolean(plan) };
    }
    if (JSON.stringify(found) !== JSON.stringify(this.store.state.prospects)) this.store.set({ prospects: found });
  }

  async #ask(plan) {
    if (this.#asking.has(plan)) return;
    this.#asking.add(plan);
    const found = await get(at("plans", plan)).catch(() => null); // asked again with the next change
    this.#asking.delete(plan);
    if (found) this.#known.set(plan, ofPlan(found));
    if (found) this.look(this.store.state);
  }
}

function ofPlan({ duration, certificate }) {
  return {
    facts: [
      ["Duration", number(duration, 2, "s")],
      ["Clearance", number(certificate.clearance.value * 1000, 0, "mm")],
      ["Reach", `${percent(certificate.position_use.value)} of the joints' range`],
    ],
  };
}
