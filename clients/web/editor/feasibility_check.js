// Asks the service whether the arm can follow the draft. Only the answer for the newest curve counts: the service assesses
// one curve of a path at a time, and another tab may be asking about this path.
import { ApiError, post, resourcePath } from "../api.js";

const RETRY_DELAY = 1000; // [ms]

/**
 * What is known of a curve: nothing while it is pending, an assessment, or why there is none; `retry`: it is asked again.
 * @typedef {{curve: Curve, pending?: boolean, assessment?: Assessment, error?: string, retry?: boolean}} Feasibility
 *
 * @typedef {import("./draft.js").Draft} Draft
 */

export class FeasibilityCheck {
  /** @type {Feasibility | null} */
  current = null;
  #asking = false;

  /**
   * @param {() => Draft | null} draftOf the draft that is looked at now, or null
   * @param {(current: Feasibility, ms: number | null) => void} onChange also told how long the answer took
   */
  constructor(draftOf, onChange) {
    this.draftOf = draftOf;
    this.onChange = onChange;
  }

  /** Ask about the present curve, unless it is known; `again` asks all the same. */
  async request(again = false) {
    const draft = this.draftOf();
    if (!draft || (!again && this.#isKnown(draft.curve))) return;
    const { curve } = draft;
    this.#set({ curve, pending: true }, null);
    if (this.#asking) return; // one request at a time; the newest curve comes next
    this.#asking = true;
    const began = performance.now();
    const answer = await ask(draft.path, curve, draft.base.number);
    this.#asking = false;
    const now = this.draftOf();
    if (!now) return;
    if (now.curve !== curve) {
      this.request(true);
      return;
    }
    this.#set(answer, answer.assessment ? performance.now() - began : null);
    if (answer.retry) setTimeout(() => this.draftOf()?.curve === curve && this.request(true), RETRY_DELAY);
  }

  /** @param {Curve} curve */
  #isKnown(curve) {
    const { current } = this;
    return current?.curve === curve && !current.pending && !current.retry;
  }

  /** @param {Feasibility} feasibility @param {number | null} ms */
  #set(feasibility, ms) {
    this.current = feasibility;
    this.onChange(feasibility, ms);
  }
}

/**
 * @param {string} path
 * @param {Curve} curve
 * @param {number} version
 * @returns {Promise<Feasibility>}
 */
async function ask(path, curve, version) {
  try {
    return { curve, assessment: await post(resourcePath("paths", path, "assessment"), { curve, version }) };
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    // Somebody else's curve of this path came first, or the service was away: it is asked again.
    return { curve, error: error.message, retry: error.status === 409 || error.status === 0 };
  }
}
