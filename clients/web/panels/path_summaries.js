// Summaries of the paths: whether the arm can follow, duration and clearance, from the newest plan, else from an assessment.
import { ApiError, get, post, resourcePath } from "../api.js";
import { latestPaths } from "../store.js";
import { formatLength, formatNumber, formatPercent } from "../texts.js";

/** @typedef {Pick<PathSummary, "verdict" | "facts" | "error">} Summary */

export class PathSummaries {
  /** @type {Map<string, Summary>} */
  #summaries = new Map(); // id of a plan, or path and version -> summary
  /** @type {Promise<void>} */
  #queue = Promise.resolve(); // one request at a time: an assessment costs the service a moment
  /** @type {Set<string>} */
  #pending = new Set();

  /** @param {import("../store.js").Store} store */
  constructor(store) {
    this.store = store;
  }

  /** @param {State} state */
  refresh(state) {
    /** @type {Record<string, PathSummary>} */
    const found = {};
    for (const path of latestPaths(state)) {
      const job = newestPlanning(path, state.jobs ?? []);
      const plan = job?.state === "succeeded" ? job.outcome : "";
      const key = plan || `${path.id} ${path.version}`;
      this.#request(key, () => (plan ? summarizePlan(plan) : summarizeAssessment(path)));
      const refused = job?.state === "failed" ? { verdict: "", facts: [], error: `Not certified: ${job.message}` } : {};
      const planning = job?.state === "queued" || job?.state === "running";
      found[path.id] = { ...this.#summaries.get(key), ...refused, planning, planned: plan !== "" };
    }
    const { pathSummaries } = this.store.state;
    if (JSON.stringify(found) !== JSON.stringify(pathSummaries)) this.store.set({ pathSummaries: found });
  }

  /** @param {string} key @param {() => Promise<Summary>} summarize */
  async #request(key, summarize) {
    if (this.#pending.has(key) || this.#summaries.has(key)) return;
    this.#pending.add(key);
    this.#queue = this.#queue.then(summarize).then(
      (summary) => {
        this.#summaries.set(key, summary);
      },
      (error) => {
        // A refusal says what is wrong with the path; without an answer it is asked again with the next change.
        if (error instanceof ApiError && error.status === 422) this.#summaries.set(key, { error: error.message });
      },
    );
    await this.#queue;
    this.#pending.delete(key);
    if (this.#summaries.has(key)) this.refresh(this.store.state);
  }
}

/**
 * The newest job that plans this version of a path.
 * @param {Pick<LearnedPath, "id" | "version">} path
 * @param {Job[]} jobs
 */
export function newestPlanning({ id, version }, jobs) {
  return jobs.find(
    ({ kind, request }) => kind === "plan" && request.path === id && (request.version ?? version) === version,
  );
}

/** @param {string} id of a plan @returns {Promise<Summary>} */
async function summarizePlan(id) {
  /** @type {Plan} */
  const { duration, certificate } = await get(resourcePath("plans", id));
  const range = formatPercent(certificate.position_use.value);
  const clearance = formatLength(certificate.clearance.value);
  return {
    verdict: `Certified: ${formatNumber(duration, 2, "s")}, clearance ${clearance}`,
    facts: [["Reach", `the whole way, ${range} of joint range`]],
  };
}

/** @param {LearnedPath} path @returns {Promise<Summary>} */
async function summarizeAssessment({ id, version, curve }) {
  /** @type {Assessment} */
  const assessment = await post(resourcePath("paths", id, "assessment"), { version, curve });
  const { duration, clearance, failure, sentence } = assessment;
  if (failure) return { error: sentence }; // which says by how much; estimates beside it would say otherwise
  const time = duration === null ? "" : `about ${formatNumber(duration, 1, "s")}, `;
  return {
    verdict: `The arm can probably follow: ${time}clearance about ${formatLength(Math.min(...clearance))}`,
    facts: [["Reach", "the whole way"]],
  };
}
