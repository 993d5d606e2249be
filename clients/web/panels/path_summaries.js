// Summaries of the paths: duration, clearance and reach, from the newest plan, else from an assessment.
import { get, post, resourcePath } from "../api.js";
import { formatNumber, formatPercent } from "../elements.js";
import { latestPaths } from "../store.js";

export class PathSummaries {
  #summaries = new Map(); // id of a plan, or path and version -> summary
  #queue = Promise.resolve(); // one request at a time: an assessment costs the service a moment
  #pending = new Set();

  constructor(store) {
    this.store = store;
  }

  refresh(state) {
    const found = {};
    for (const path of latestPaths(state)) {
      const jobs = (state.jobs ?? []).filter(
        (job) =>
          job.kind === "plan" && job.request.path === path.id && (job.request.version ?? path.version) === path.version,
      );
      const last = jobs.at(-1);
      const planning = ["queued", "running"].includes(last?.state);
      const plan = last?.state === "succeeded" ? last.outcome : "";
      const key = plan || `${path.id} ${path.version}`;
      this.#request(
        key,
        plan
          ? () => get(resourcePath("plans", plan)).then(planSummary)
          : () =>
              post(`${resourcePath("paths", path.id)}/assessment`, { version: path.version, curve: path.curve }).then(
                assessmentSummary,
              ),
      );
      const refused = last?.state === "failed" ? { error: `Not certified: ${last.message}` } : {};
      found[path.id] = { ...this.#summaries.get(key), ...refused, planning, planned: Boolean(plan) };
    }
    if (JSON.stringify(found) !== JSON.stringify(this.store.state.pathSummaries))
      this.store.set({ pathSummaries: found });
  }

  async #request(key, question) {
    if (this.#pending.has(key) || this.#summaries.has(key)) return;
    this.#pending.add(key);
    this.#queue = this.#queue.then(question).then(
      (found) => this.#summaries.set(key, found),
      // a refusal says what is wrong with the path; without an answer it is asked again with the next change
      (error) => error.status === 422 && this.#summaries.set(key, { error: error.message }),
    );
    await this.#queue;
    this.#pending.delete(key);
    if (this.#summaries.has(key)) this.refresh(this.store.state);
  }
}

function planSummary({ duration, certificate }) {
  return {
    facts: [
      ["Duration", formatNumber(duration, 2, "s")],
      ["Clearance", formatNumber(certificate.clearance.value * 1000, 0, "mm")],
      ["Reach", `the whole way, ${formatPercent(certificate.position_use.value)} of joint range`],
    ],
  };
}

function assessmentSummary({ duration, clearance, reach, failure, sentence }) {
  return {
    facts: [
      ["Duration", duration !== null && `about ${formatNumber(duration, 1, "s")}`],
      ["Clearance", clearance.length > 0 && `about ${formatNumber(Math.min(...clearance) * 1000, 0, "mm")}`],
      [
        "Reach",
        reach.length > 0 &&
          (Math.min(...reach) >= 0 ? "the whole way" : `${formatNumber(-Math.min(...reach) * 1000, 0, "mm")} short`),
      ],
    ],
    error: failure ? sentence : "",
  };
}
