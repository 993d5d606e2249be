// What lies before each path: duration, clearance and reach, from its newest plan, else from a quick look at it.
import { at, get, post } from "../api.js";
import { number, percent } from "../elements.js";
import { pathsOf } from "../store.js";

export class Prospects {
  #known = new Map(); // what was asked about, a plan or a version of a path -> what was found
  #last = Promise.resolve(); // one question at a time: a look costs the service a moment
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
      const key = plan || `${path.id} ${path.version}`;
      this.#ask(key, plan ? () => get(at("plans", plan)).then(ofPlan) : () => post(`${at("paths", path.id)}/assessment`, { version: path.version, curve: path.curve }).then(ofLook));
      const refused = last?.state === "failed" ? { fault: `Not certified: ${last.message}` } : {};
      found[path.id] = { ...this.#known.get(key), ...refused, planning, planned: Boolean(plan) };
    }
    if (JSON.stringify(found) !== JSON.stringify(this.store.state.prospects)) this.store.set({ prospects: found });
  }

  async #ask(key, question) {
    if (this.#asking.has(key) || this.#known.has(key)) return;
    this.#asking.add(key);
    this.#last = this.#last.then(question).then(
      (found) => this.#known.set(key, found),
      // a refusal says what is wrong with the path; without an answer it is asked again with the next change
      (error) => error.status === 422 && this.#known.set(key, { fault: error.message }),
    );
    await this.#last;
    this.#asking.delete(key);
    if (this.#known.has(key)) this.look(this.store.state);
  }
}

function ofPlan({ duration, certificate }) {
  return {
    facts: [
      ["Duration", number(duration, 2, "s")],
      ["Clearance", number(certificate.clearance.value * 1000, 0, "mm")],
      ["Reach", `the whole way, ${percent(certificate.position_use.value)} of joint range`],
    ],
  };
}

function ofLook({ duration, clearance, reach, failure, sentence }) {
  return {
    facts: [
      ["Duration", duration !== null && `about ${number(duration, 1, "s")}`],
      ["Clearance", clearance.length > 0 && `about ${number(Math.min(...clearance) * 1000, 0, "mm")}`],
      ["Reach", reach.length > 0 && (Math.min(...reach) >= 0 ? "the whole way" : `${number(-Math.min(...reach) * 1000, 0, "mm")} short`)],
    ],
    fault: failure ? sentence : "",
  };
}
