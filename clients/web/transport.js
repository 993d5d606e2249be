// How a request reaches the service; a review package has another transport, which answers from what it holds.
const REQUEST_TIMEOUT = 30_000; // [ms]
const NO_ANSWER = "The service does not answer. Is it running? This page connects again by itself.";

/**
 * Send a request to the REST API.
 * @param {string} method
 * @param {string} path below /api/v1
 * @param {RequestInit} options
 * @param {number} timeout [ms]
 * @returns {Promise<Response>}
 * @throws {Error} without an answer; its message is a sentence with a way out
 */
export async function send(method, path, options, timeout = REQUEST_TIMEOUT) {
  const signal = AbortSignal.timeout(timeout);
  try {
    // Modules lie under web/, beside api/, wherever a proxy puts both.
    return await fetch(new URL(`../api/v1/${path}`, import.meta.url), { method, signal, ...options });
  } catch {
    const late = `The service has not answered for ${timeout / 1000} s; it may be busy. Try again.`;
    throw new Error(signal.aborted ? late : NO_ANSWER);
  }
}
