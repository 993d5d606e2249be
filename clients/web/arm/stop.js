// Stop: sent again and again until the service says that the executor's own status shows it.

/** @typedef {"" | "stopping" | "not stopped"} StopState "not stopped" after a while without a confirmation */

const CONFIRM_TIME = 300; // [ms] in which a stop is confirmed, or said to be none
const RETRY_INTERVAL = 200; // [ms] between two tries; the service repeats each of them by itself

export class ArmStop {
  /** @type {StopState} */
  state = "";
  #path = ""; // of the stop that waits to be confirmed
  /** @type {Promise<void> | null} */
  #sending = null;

  /** Called when `state` has changed, with the one before. */
  onChange = (/** @type {StopState} */ _before) => {};

  /** @param {(path: string) => Promise<unknown>} send posts a stop; its answer says that the arm stops */
  constructor(send) {
    this.send = send;
  }

  /**
   * Stop whatever moves the arm, or one execution. Resolves when it is confirmed.
   * @param {string} path of the resource
   */
  request(path = "stop") {
    if (this.#sending && this.#path === "stop") return this.#sending; // that stops whatever moves
    this.#path = path;
    this.#sending ??= this.#sendUntilConfirmed();
    return this.#sending;
  }

  async #sendUntilConfirmed() {
    this.#setState("stopping");
    const timer = setTimeout(() => this.#setState("not stopped"), CONFIRM_TIME);
    while (!(await this.#isConfirmed())) await new Promise((resolve) => setTimeout(resolve, RETRY_INTERVAL));
    clearTimeout(timer);
    this.#sending = null;
    this.#setState("");
  }

  /** Whether the newest stop that was asked for is confirmed. */
  async #isConfirmed() {
    const path = this.#path;
    try {
      await this.send(path);
    } catch {
      return false; // refused, late or lost: it is not known that the arm stops
    }
    return path === this.#path;
  }

  /** @param {StopState} state */
  #setState(state) {
    const before = this.state;
    this.state = state;
    this.onChange(before);
  }
}
