// Control of the arm: taken, kept with beats, given back. Whoever holds it alone gives orders; everybody may stop.
import { ApiError, post } from "../api.js";

const LEASE_DURATION = 6; // [s] that the service waits for a beat
const HEARTBEAT_INTERVAL = 2000; // [ms]
const LEASE_HEADER = "Teachpath-Lease";

class ControlLease {
  token = "";
  #name = "";
  #timer = 0;
  waiting = false; // asked for, and not yet given

  /** Called when control was gained, lost or asked for. */
  onChange = () => {};

  get held() {
    return this.token !== "" && !this.waiting;
  }

  /**
   * Headers of an order; without control they are none, which suffices while nobody holds it.
   * @returns {Record<string, string>}
   */
  get headers() {
    return this.token ? { [LEASE_HEADER]: this.token } : {};
  }

  /** @param {string} name */
  async take(name) {
    this.#name = name;
    this.#begin(await post("lease", { name, seconds: LEASE_DURATION }));
  }

  /**
   * Ask the holder; who says nothing loses control after a while.
   * @param {string} name
   */
  async ask(name) {
    const lease = await post("lease/ask", { name, seconds: LEASE_DURATION });
    this.#name = name;
    this.waiting = true;
    this.#begin(lease);
  }

  async release() {
    const { headers } = this;
    this.#end();
    await post("lease/release", {}, headers);
  }

  async keep() {
    await post("lease/keep", {}, this.headers);
  }

  /** @param {{token: string}} lease */
  #begin(lease) {
    this.token = lease.token;
    clearInterval(this.#timer);
    this.#timer = setInterval(() => this.#heartbeat(), HEARTBEAT_INTERVAL);
    this.onChange();
  }

  async #heartbeat() {
    const { token } = this;
    try {
      const lease = await post("lease/beat", {}, this.headers);
      if (token !== this.token) return; // given back meanwhile, perhaps taken anew
      if (lease.holder === this.#name) this.waiting = false;
      this.onChange();
    } catch (error) {
      if (error instanceof ApiError && error.status && token === this.token) this.#end(); // refused: it has lapsed, or somebody was given it
    }
  }

  #end() {
    clearInterval(this.#timer);
    this.token = "";
    this.waiting = false;
    this.onChange();
  }
}

/** This page's: whatever it orders the arm goes by it. */
export const lease = new ControlLease();
