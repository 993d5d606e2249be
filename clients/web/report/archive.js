// The transport of a review package: answers requests from the documents that the package holds, and takes no orders.
const place = document.getElementById("archive");

/** @type {Record<string, unknown>} documents of the REST API by their path */
const documents = JSON.parse(place?.textContent ?? "{}");

/**
 * Answer a request as the service would; the same signature as `send` in transport.js.
 * @param {string} method
 * @param {string} path below /api/v1; a query is not looked at
 */
export async function send(method, path) {
  const [name] = path.split("?");
  if (method !== "GET") return refusal(405, "This is a review package: nothing can be changed or ordered in it.");
  if (!Object.hasOwn(documents, name))
    return refusal(404, `The review package does not hold ${name}. Plan the path again and export another package.`);
  return Response.json(documents[name]);
}

/** @param {number} status @param {string} detail */
const refusal = (status, detail) => Response.json({ detail }, { status });
