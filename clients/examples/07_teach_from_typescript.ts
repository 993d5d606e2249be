// Teach a task from TypeScript: hear the events of a station, import a demonstration, wait for the job, list what came.
//
//     node 07_teach_from_typescript.ts http://127.0.0.1:8765 cups cups.csv [TOKEN]
//
// Node 24 runs it as it is, without a package. The types are those that openapi-typescript makes of /openapi.json; they are
// gone when it runs. Numbers that end in _ns have more digits than a number of JavaScript holds: they are read as BigInt.
import { readFile } from "node:fs/promises";
import { basename } from "node:path";
import type { components } from "../../tools/page/types/api.d.ts"; // npx openapi-typescript URL/openapi.json -o api.d.ts

type Job = components["schemas"]["Job"];
type Demonstration = components["schemas"]["Demonstration"];
type Refusal = components["schemas"]["Refusal"];

const [url, task, file, token] = process.argv.slice(2);
if (!url || !task || !file) throw new Error("name the station, a task and a file with columns t, x, y, z");

/** Read JSON, and numbers of nanoseconds as BigInt. */
function parse(text: string) {
  type Context = { source: string };
  const revive = (key: string, value: unknown, context?: Context) =>
    key.endsWith("_ns") && context ? BigInt(context.source) : value;
  return JSON.parse(text, revive as (key: string, value: unknown) => unknown);
}

/** Send a request and return the answer; a refusal is an error with the station's own sentence. */
async function ask<T>(method: string, resource: string, body?: Uint8Array<ArrayBuffer>, headers = {}): Promise<T> {
  const signed = token ? { Authorization: `Bearer ${token}`, ...headers } : headers;
  const answer = await fetch(`${url}/api/v1/${resource}`, { method, body, headers: signed });
  const document = parse(await answer.text());
  if (!answer.ok) throw new Error((document as Refusal).detail);
  return document as T;
}

/** Return a job that has ended: asked for whenever an event says that it has changed, or that everything may have. */
function ended(id: string): Promise<Job> {
  const address = `${url.replace("http", "ws")}/api/v1/events`;
  const socket = new WebSocket(address, { headers: token ? { Authorization: `Bearer ${token}` } : {} } as never);
  return new Promise((resolve, reject) => {
    socket.addEventListener("error", () => reject(new Error(`the events of ${url} cannot be heard`)));
    socket.addEventListener("message", async ({ data }) => {
      const event = parse(data) as { topic: string; id: string };
      if (event.topic !== "all" && !(event.topic === "jobs" && event.id === id)) return;
      const job = await ask<Job>("GET", `jobs/${id}`).catch(reject);
      if (!job?.finished_ns) return;
      socket.close();
      resolve(job);
    });
  });
}

const name = encodeURIComponent(basename(file));
const place = `tasks/${encodeURIComponent(task)}/demonstrations`;
const key = { "Idempotency-Key": crypto.randomUUID() }; // sent again, this order would begin nothing
const job = await ended((await ask<Job>("POST", `${place}?name=${name}`, await readFile(file), key)).id);
if (job.state !== "succeeded") throw new Error(job.message);
for (const { number, verdict, duration, created_ns } of await ask<Demonstration[]>("GET", place)) {
  console.log(`${task} ${number}: ${verdict}, ${duration.toFixed(2)} s, made at ${created_ns} ns`);
}
