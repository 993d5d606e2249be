// The REST API of the service: every answer is a document, every failure a sentence with a way out.
import { send } from "./transport.js";

/**
 * What the service refused, or that it did not answer (status 0). `kind` is the service's name of it, e.g. "Conflict";
 * `newer` is the version that was saved meanwhile.
 */
export class ApiError extends Error {
  /**
   * @param {string} sentence
   * @param {{status?: number, kind?: string, newer?: Version | null}} details
   */
  constructor(sentence, { status = 0, kind = "", newer = null } = {}) {
    super(sentence);
    this.status = status;
    this.kind = kind;
    this.newer = newer;
  }
}

/**
 * Whether what failed may go well when it is tried again: there was no answer, too many asked, or the service could not.
 * @param {unknown} error
 */
export const isPassing = (error) => error instanceof ApiError && [0, 429, 502, 503, 504].includes(error.status);

export const RETRY_DELAY = 3000; // [ms] after which it is

const KEEP_TIME = 60_000; // [ms] that a file is kept for the browser to save it
const PAGE_SIZE = 500; // entries of a list that are asked for at a time, as many as the service gives

/** @param {string} path */
export const get = (path) => call("GET", path);

/**
 * One page of a list: its entries, and where the next page is, empty at the end.
 * @param {string} path
 * @returns {Promise<{entries: any[], next: string}>}
 */
export async function getPage(path) {
  const { answer, document } = await request("GET", path);
  const next = answer.headers.get("Link")?.match(/<\/api\/v1\/([^>]+)>; rel="next"/)?.[1] ?? "";
  return { entries: document, next };
}

/**
 * A whole list, page by page.
 * @param {string} path perhaps with a query
 * @returns {Promise<any[]>}
 */
export async function getList(path) {
  const list = [];
  const mark = path.includes("?") ? "&" : "?";
  for (let place = `${path}${mark}limit=${PAGE_SIZE}`; place; ) {
    const { entries, next } = await getPage(place);
    list.push(...entries);
    place = next;
  }
  return list;
}

/** @param {string} path @param {object} body @param {Record<string, string>} headers @param {number} [timeout] [ms] */
export const post = (path, body = {}, headers = {}, timeout = undefined) => call("POST", path, body, headers, timeout);

/** @param {string} path @param {object} body */
export const put = (path, body = {}) => call("PUT", path, body);

/** @param {string} path @param {object} body */
export const patch = (path, body = {}) => call("PATCH", path, body);

/** @param {string} path */
export const remove = (path) => call("DELETE", path);

const UPLOAD_TIMEOUT = 600_000; // [ms]

/**
 * Send a file as it is.
 * @param {string} path
 * @param {Blob} content
 */
export const upload = async (path, content) =>
  (await request("POST", path, content, { "Content-Type": "application/octet-stream" }, UPLOAD_TIMEOUT)).document;

/** The content of a file. @param {string} path */
export const read = async (path) => (await accepted("GET", path, {}, UPLOAD_TIMEOUT)).blob();

/**
 * Where a resource is, e.g. resourcePath("tasks", name, "runs"); every piece is escaped.
 * @param {...(string | number)} pieces
 */
export const resourcePath = (...pieces) => pieces.map(encodeURIComponent).join("/");

/** @param {string} path below /api/v1, which lies beside the modules' folder, wherever a proxy puts both */
export function socketUrl(path) {
  const url = new URL(`../api/v1/${path}`, import.meta.url);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}

/**
 * Let the browser save a file under the name that the service gives it.
 * @param {string} path
 */
export async function download(path) {
  const answer = await accepted("GET", path);
  const name = answer.headers.get("Content-Disposition")?.match(/filename="([^"]+)"/)?.[1] ?? "";
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEEP_TIME); // the browser reads it after the click
}

/**
 * @param {string} method
 * @param {string} path
 * @param {object} [body]
 * @param {Record<string, string>} further headers
 * @param {number} [timeout] [ms]
 * @returns {Promise<any>} the document
 */
async function call(method, path, body, further = {}, timeout = undefined) {
  return (await request(method, path, body, further, timeout)).document;
}

/**
 * @param {string} method
 * @param {string} path
 * @param {object} [body]
 * @param {Record<string, string>} further headers
 * @param {number} [timeout] [ms]
 * @returns {Promise<{answer: Response, document: any}>}
 */
async function request(method, path, body, further = {}, timeout = undefined) {
  /** @type {Record<string, string>} */
  const headers = { ...further, Accept: "application/json" };
  if (body !== undefined) headers["Content-Type"] ??= "application/json";
  const content = body instanceof Blob ? body : body && JSON.stringify(body);
  const answer = await accepted(method, path, { headers, body: content }, timeout);
  return { answer, document: await answer.json().catch(() => null) };
}

/**
 * @param {string} method
 * @param {string} path
 * @param {RequestInit} [options]
 * @param {number} [timeout] [ms]
 * @returns {Promise<Response>} an answer that is no refusal
 */
async function accepted(method, path, options = {}, timeout = undefined) {
  const answer = await send(method, path, options, timeout).catch((error) => {
    throw new ApiError(error.message);
  });
  if (answer.ok) return answer;
  const document = await answer.json().catch(() => null);
  const { detail, error: kind, newer } = document ?? {};
  const unknown = `The service answered ${method} ${path} with status ${answer.status}; look into its log.`;
  throw new ApiError(detail ?? unknown, { status: answer.status, kind, newer });
}
