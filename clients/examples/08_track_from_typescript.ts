// A tracker in TypeScript: show a demonstration to a station over its WebSocket, in JSON, and print what became of it.
//
//     node 08_track_from_typescript.ts http://127.0.0.1:8765 arc [SPEED] [TOKEN]
//
// Node 24 runs it as it is, without a package. The types are made of /openapi.json, as those of 07_teach_from_typescript.ts;
// /asyncapi.json describes the messages. Whatever moves can teach: here a function draws an arc from the object of the
// scene `paper` to the other side, as in 01_publish_a_demonstration.py.
import { setTimeout } from "node:timers/promises";
import type { components } from "../../tools/page/types/api.d.ts";

type Demonstration = components["schemas"]["Demonstration"];
type Refusal = components["schemas"]["Refusal"];
type Report = components["schemas"]["RecordingReport"];
type Place = [x: number, y: number, z: number];

const [url, task, speed = "1", token] = process.argv.slice(2);
if (!url || !task) throw new Error("name the station and a task");
const signed = token ? { Authorization: `Bearer ${token}` } : {};

const TRACKER = "typescript-hand";
const PERIOD = 20; // [ms] between two readings
const START: Place = [0.58, -0.28, 0.52]; // of the object's centre [m]
const GOAL: Place = [0.58, 0.28, 0.52];
const GRASP = 1; // bit 0 of the buttons, which is set while the object is carried

/** Yield the hand's positions and buttons: wait at the start, carry over an arc, let go, and rest for as long as asked. */
function* readings(): Generator<[Place, number]> {
  for (let i = 0; i < 25; i++) yield [START, 0];
  for (let i = 0; i < 150; i++) {
    const u = (1 - Math.cos((Math.PI * i) / 149)) / 2;
    const bow = Math.sin(Math.PI * u);
    yield [[START[0] + 0.2 * bow, START[1] + u * (GOAL[1] - START[1]), START[2] + 0.1 * bow], GRASP];
  }
  while (true) yield [GOAL, 0];
}

/** Send a request and return the answer; a refusal is an error with the station's own sentence. */
async function ask<T>(method: string, resource: string, body?: object): Promise<T> {
  const headers = { ...signed, "Content-Type": "application/json" };
  const answer = await fetch(`${url}/api/v1/${resource}`, { method, headers, body: body && JSON.stringify(body) });
  const document = await answer.json();
  if (!answer.ok) throw new Error((document as Refusal).detail);
  return document as T;
}

/** Connect the tracker, which has its name for as long as the connection lasts; it ends at the first refusal. */
function connect(heard: (report: Report) => void, fail: (error: Error) => void): Promise<WebSocket> {
  const address = `${url.replace("http", "ws")}/api/v1/trackers/${TRACKER}/samples`;
  const socket = new WebSocket(address, { headers: signed } as never);
  socket.addEventListener("error", () => fail(new Error(`${address} cannot be reached, or was closed`)));
  socket.addEventListener("close", ({ code, reason }) => fail(new Error(`the station has closed: ${reason || code}`)));
  socket.addEventListener("message", ({ data }) => {
    const { report, refused } = JSON.parse(data);
    if (report) heard(report);
    else fail(new Error(refused));
  });
  return new Promise((resolve) => socket.addEventListener("open", () => resolve(socket)));
}

const place = `tasks/${encodeURIComponent(task)}`;
await ask("PUT", place, { scene: "paper" });
const account = Promise.withResolvers<Report>();
account.promise.catch((error) => {
  console.error(error.message);
  process.exit(1);
});
const socket = await connect(account.resolve, account.reject);
await ask<Report>("POST", `${place}/recording`, { tracker: TRACKER, rate: 1000 / PERIOD });
const begun = BigInt(Date.now()) * 1_000_000n;
let sequence = 0;
for (const [[x, y, z], buttons] of readings()) {
  sequence += 1;
  const device_ns = String(begun + BigInt(sequence * PERIOD) * 1_000_000n); // has more digits than a number
  socket.send(JSON.stringify({ sample: { sequence, device_ns, position: { x, y, z }, tracked: true, buttons } }));
  await setTimeout(PERIOD / Number(speed));
  if (sequence % 50 > 0) continue;
  const recordings = await ask<Report[]>("GET", `${place}/recording`);
  if (recordings.some(({ tracker, demonstrations }) => tracker === TRACKER && demonstrations.length > 0)) break;
}
socket.send(JSON.stringify({ end: sequence })); // answered with the account of every sample
const { demonstrations, received, lost } = await account.promise;
socket.close();
console.log(`${received} samples, ${lost} lost`);
for (const id of demonstrations) {
  const { number, verdict, duration } = await ask<Demonstration>("GET", `demonstrations/${id}`);
  console.log(`${task} ${number}: ${verdict}, ${duration.toFixed(2)} s`);
}
