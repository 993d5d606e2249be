// The panel: what the REST API knows about the task and the arm, asked once a second.
import { element, number, percent, plural, replace } from "./elements.js";

const PERIOD = 1000; // [ms]
const STATION_PERIOD = 400; // [ms] trackers are shown within a second of coming or going
const LISTED = 40; // newest demonstrations
const WAYS = 6; // colours --way-0 to --way-5

export class Panel {
  constructor(document) {
    this.at = (id) => document.getElementById(id);
    this.task = "";
    this.station = null;
    this.refusal = "";
    this.working = { recordings: [], jobs: [] };
  }

  start() {
    this.at("task").addEventListener("change", (event) => {
      this.task = event.target.value;
    });
    for (const id of ["work", "demonstrations"]) this.at(id).addEventListener("click", (event) => this.#order(event));
    const every = async (period, step) => {
      if (!document.hidden) await step();
      setTimeout(every, period, period, step);
    };
    every(PERIOD, () => this.refresh());
    every(STATION_PERIOD, async () => {
      this.station = await get("health");
      this.#work();
    });
  }

  async refresh() {
    const [tasks, executions] = await Promise.all([get("tasks"), get("executions")]);
    this.#tasks(tasks);
    this.#arm(executions);
    const here = this.task && `tasks/${encodeURIComponent(this.task)}`;
    const of = (what) => (here ? get(`${here}/${what}`) : (tasks && []));
    const [jobs, recordings, demonstrations, runs] = await Promise.all(["jobs", "recording", "demonstrations", "runs"].map(of));
    this.working = { recordings: recordings ?? [], jobs: jobs ?? [] };
    this.#work();
    this.#demonstrations(demonstrations);
    this.#learned(runs, demonstrations ?? []);
  }

  #tasks(tasks) {
    const names = (tasks ?? []).map((task) => task.name);
    if (!names.includes(this.task)) this.task = names.at(-1) ?? "";
    const select = this.at("task");
    if ([...select.options].map((o) => o.value).join("\n") !== names.join("\n")) {
      select.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    }
    select.value = this.task;
    select.parentElement.hidden = names.length === 0;
  }

  #arm(executions) {
    const status = executions?.[0]?.status; // newest first
    if (!status) {
      replace(this.at("arm"), hint(executions ? "At rest. Nothing has been executed yet." : "The service does not answer."));
      return;
    }
    replace(
      this.at("arm"),
      element("p", { class: "state" }, element("span", { class: `dot ${status.state}` }), sentence(status.state), status.reason && `: ${status.reason}`),
      bar(status.progress, "progress along the path"),
      facts([
        ["Speed", percent(status.override)],
        ["Duration", status.duration > 0 && number(status.duration, 1, "s")],
        ["Largest tracking error", status.tracking_error > 0 && number(status.tracking_error * 1000, 2, "mrad")],
        ["Largest limit use", status.limit_use > 0 && percent(status.limit_use)],
        ["Setpoints late, missed", status.cycles > 0 && `${status.late}, ${status.missed} of ${number(status.cycles, 0)}`],
      ]),
    );
  }

  // Trackers that are there, recordings and jobs that run; the last job that failed stays until another one begins.
  #work() {
    const { recordings, jobs } = this.working;
    const running = jobs.filter((job) => job.state === "running" || job.state === "queued");
    const failed = jobs.at(-1)?.state === "failed" ? [jobs.at(-1)] : [];
    const there = (this.station?.trackers ?? []).filter((t) => !recordings.some((r) => r.tracker === t.name));
    const lines = [
      ...recordings.map(recordingLine),
      ...there.map((t) => element("p", { class: "job" }, element("span", { class: "dot there" }), `${t.name} is here`)),
      ...running.map((job) => element("div", { class: "job" }, element("p", {}, `${sentence(job.kind)}: ${job.message || job.state}`), bar(job.fraction, `${job.kind} job`))),
      ...failed.map((job) => element("p", { class: "job failed" }, `${sentence(job.kind)} failed: ${job.message}`)),
      this.refusal && element("p", { class: "job failed" }, this.refusal),
      ...(this.station?.notes ?? []).map((note) => element("p", { class: "job note" }, sentence(note))),
    ];
    this.at("work-section").hidden = !lines.some(Boolean);
    replace(this.at("work"), ...lines);
  }

  // A button names what it orders: a verb of the recording, and the tracker where one is meant.
  async #order(event) {
    const { verb, tracker } = event.target.closest("button[data-verb]")?.dataset ?? {};
    if (!verb) return;
    this.refusal = await post(`tasks/${encodeURIComponent(this.task)}/recording/${verb}`, tracker && { tracker });
    await this.refresh();
  }

  #demonstrations(demonstrations) {
    if (!demonstrations?.length) {
      
      replace(
        this.at("demonstrations"),
        hint(demonstrations ? "No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:" : "The demonstrations cannot be read: the service does not answer."),
        demonstrations && element("pre", {}, element("code", {}, `teachpath-client synthetic${this.task && ` --task ${this.task}`}`)),
      );
      return;
    }
    const kept = demonstrations.filter((d) => !d.discarded_ns);
    const count = (verdict) => kept.filter((d) => d.verdict === verdict).length;
    const mean = kept.reduce((sum, d) => sum + d.duration, 0) / kept.length;
    const advice = this.station?.coach?.task === this.task && this.station.coach.sentence;
    replace(
      this.at("demonstrations"),
      element("p", { class: "count" }, element("strong", {}, String(kept.length)), ` ${plural(kept.length, "demonstration")}`),
      advice && element("p", { class: "coach" }, `${sentence(advice)}.`),
      facts([
        ["Clean", String(count("clean"))],
        ["Repaired", count("repaired") && String(count("repaired"))],
        ["Not usable", count("reject") && String(count("reject"))],
        ["Mean transport", kept.length > 0 && number(mean, 1, "s")],
        ["Samples lost", String(kept.reduce((sum, d) => sum + (d.account?.lost ?? 0), 0))],
      ]),
      element("ol", { class: "takes", "aria-label": "demonstrations, newest first" }, ...demonstrations.slice(-LISTED).reverse().map(takeLine)),
      element(
        "p",
        { class: "orders" },
        kept.length > 0 && button("discard", "Discard the last"),
        kept.length < demonstrations.length && button("restore", "Undo discard"),
      ),
    );
  }

  #learned(runs, demonstrations) {
    const run = runs?.[0]?.learned; // newest first
    if (!run?.clusters.length) {
      replace(
        this.at("learned"),
        hint(runs ? "Nothing learned yet. When the task has been shown a few times, start a learning job:" : "The runs cannot be read: the service does not answer."),
        runs && element("pre", {}, element("code", {}, `teachpath learn ${this.task || "TASK"}`)),
      );
      return;
    }
    const numbers = new Map(demonstrations.map((d) => [d.id, d.number]));
    const head = element("thead", {}, element("tr", {}, ...["Way", "Demonstration", "Log-likelihood", "Selected"].map((t) => element("th", { scope: "col" }, t))));
    replace(this.at("learned"), element("table", {}, head, ...run.clusters.map((cluster) => rows(cluster, numbers))), ...notes(run));
  }
}

function recordingLine(r) {
  const paused = r.state === "paused" || r.state === "pausing";
  const doing = { recording: r.phase, pausing: "will pause after this one", paused: "paused", lost: "the tracker has gone" }[r.state] ?? r.phase;
  return element(
    "p",
    { class: "job" },
    element("span", { class: `dot ${r.state || "recording"}` }),
    `Recording ${r.tracker}: ${doing || "waiting"}, ${r.received} ${plural(r.received, "sample")}`,
    r.lost > 0 && `, ${r.lost} lost`,
    " ",
    r.state !== "lost" && button(paused ? "resume" : "pause", paused ? "Resume" : "Pause", r.tracker),
  );
}

function takeLine(d) {
  const why = [d.mark && `marked ${d.mark}`, ...(d.reasons ?? [])].filter(Boolean).join("; ");
  const word = d.discarded_ns ? "discarded" : d.verdict;
  return element(
    "li",
    { class: word, value: String(d.number) },
    element("span", { class: "number" }, String(d.number)),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, number(d.duration, 1, "s")),
    why && element("span", { class: "why" }, sentence(why)),
  );
}

function button(verb, text, tracker = "") {
  return element("button", { type: "button", "data-verb": verb, ...(tracker && { "data-tracker": tracker }) }, text);
}

function rows(cluster, numbers) {
  const way = element(
    "th",
    { scope: "rowgroup", rowspan: String(cluster.scores.length) },
    element("span", { class: `swatch way-${(cluster.index - 1) % WAYS}` }),
    String(cluster.index),
  );
  return element(
    "tbody",
    {},
    ...cluster.scores.map((score, i) =>
      element(
        "tr",
        { class: score.selected ? "selected" : "" },
        i === 0 && way,
        element("td", { class: "figure" }, String(numbers.get(score.demonstration) ?? score.demonstration)),
        element("td", { class: "figure" }, number(score.log_likelihood, 1)),
        element("td", {}, score.selected && element("span", { class: "tick", role: "img", "aria-label": "selected", title: "The path of this way is fitted to it." }, "✓")),
      ),
    ),
  );
}

function notes(run) {
  const texts = [...run.notes, ...run.clusters.map((c) => c.note && `Way ${c.index}: ${c.note}`)].filter(Boolean);
  return texts.map((text) => element("p", { class: "note" }, text));
}

function facts(pairs) {
  return element("dl", {}, ...pairs.filter(([, value]) => value).flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

function bar(share, label) {
  return element("progress", { max: "1", value: String(share ?? 0), "aria-label": label });
}

function hint(text) {
  return element("p", { class: "hint" }, text);
}

function sentence(word) {
  return word ? word[0].toUpperCase() + word.slice(1) : "";
}

// null when the service does not answer: the page says so and asks again a second later.
async function get(path) {
  try {
    const answer = await fetch(`/api/v1/${path}`, { signal: AbortSignal.timeout(5000), headers: { Accept: "application/json" } });
    return answer.ok ? await answer.json() : null;
  } catch {
    return null;
  }
}

// Why the service refused, or nothing.
async function post(path, body) {
  try {
    const answer = await fetch(`/api/v1/${path}`, {
      method: "POST",
      signal: AbortSignal.timeout(5000),
      headers: { Accept: "application/json", "Content-Type": "application/json" },
      body: JSON.stringify(body || {}),
    });
    return answer.ok ? "" : (await answer.json()).detail;
  } catch {
    return "The service does not answer.";
  }
}
