// The REST API of the service: every answer is a document, every failure a sentence with a way out.
const REQUEST_TIMEOUT = 30_000; // [ms]
const NO_ANSWER = "The service does not answer. Is it running? This page connects again by itself.";

// What the service refused, or that it did not answer (status 0).
export class ApiError extends Error {
  constructor(sentence, { status = 0, kind = "", errors = [], newer = null } = {}) {
    super(sentence);
    this.status = status;
    this.kind = kind; // the service's name of it, e.g. "Conflict"
    this.errors = errors; // [{place, fault}] of the fields that cannot be used
    this.newer = newer; // the version that was saved meanwhile
  }
}

export const get = (path) => call("GET", path);
export const post = (path, body = {}, headers = {}) => call("POST", path, body, headers);
export const put = (path, body = {}) => call("PUT", path, body);
export const patch = (path, body = {}) => call("PATCH", path, body);
export const remove = (path) => call("DELETE", path);

// Where a resource is, e.g. at("tasks", name, "runs"); every piece is escaped.
export const resourcePath = (...pieces) => pieces.map(encodeURIComponent).join("/");

export function socketUrl(path) {
  return `${location.protocol === "https:" ? "wss:" : "ws:"}//${location.host}/api/v1/${path}`;
}

async function call(method, path, body, further = {}) {
  const headers = {
    ...further,
    Accept: "application/json",
    ...(body !== undefined && { "Content-Type": "application/json" }),
  };
  let answer;
  try {
    answer = await fetch(`/api/v1/${path}`, {
      method,
      headers,
      body: body && JSON.stringify(body),
      signal: AbortSignal.timeout(REQUEST_TIMEOUT),
    });
  } catch (error) {
    throw new ApiError(
      error.name === "TimeoutError"
        ? `The service has not answered for ${REQUEST_TIMEOUT / 1000} s; it may be busy. Try again.`
        : NO_ANSWER,
    );
  }
  const document = await answer.json().catch(() => null);
  if (answer.ok) return document;
  const sentence =
    document?.detail ?? `The service answered ${method} ${path} with status ${answer.status}; look into its log.`;
  throw new ApiError(sentence, {
    status: answer.status,
    kind: document?.error,
    errors: document?.errors,
    newer: document?.newer,
  });
}
