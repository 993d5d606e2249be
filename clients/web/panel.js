// The panel: what the REST API knows about the task and the arm, asked once a second.
import { element, number, percent, plural, replace } from "./elements.js";

const PERIOD = 1000; // [ms]
const WAYS = 6; // colours --way-0 to --way-5

export class Panel {
  constructor(document) {
    this.at = (id) => document.getElementById(id);
    this.task = "";
  }

  start() {
    this.at("task").addEventListener("change", (event) => {
      this.task = event.target.value;
    });
    const turn = async () => {
      if (!document.hidden) await this.refresh();
      setTimeout(turn, PERIOD);
    };
    turn();
  }

  async refresh() {
    const [tasks, executions] = await Promise.all([get("tasks"), get("executions")]);
    this.#tasks(tasks);
    this.#arm(executions);
    const here = this.task && `tasks/${encodeURIComponent(this.task)}`;
    const of = (what) => (here ? get(`${here}/${what}`) : (tasks && []));
    const [jobs, recordings, demonstrations, runs] = await Promise.all(["jobs", "recording", "demonstrations", "runs"].map(of));
    this.#work(recordings, jobs);
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

  // Recordings and jobs that run now; the last job that failed stays until another one begins.
  #work(recordings, jobs) {
    const running = (jobs ?? []).filter((job) => job.state === "running" || job.state === "queued");
    const failed = jobs?.at(-1)?.state === "failed" ? [jobs.at(-1)] : [];
    const lines = [
      ...(recordings ?? []).map((r) =>
        element("p", { class: "job" }, element("span", { class: "dot recording" }), `Recording ${r.tracker}: ${r.phase || "waiting"}, ${r.received} ${plural(r.received, "sample")}`),
      ),
      ...running.map((job) => element("div", { class: "job" }, element("p", {}, `${sentence(job.kind)}: ${job.message || job.state}`), bar(job.fraction, `${job.kind} job`))),
      ...failed.map((job) => element("p", { class: "job failed" }, `${sentence(job.kind)} failed: ${job.message}`)),
    ];
    this.at("work-section").hidden = lines.length === 0;
    replace(this.at("work"), ...lines);
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
    const count = (verdict) => demonstrations.filter((d) => d.verdict === verdict).length;
    const mean = demonstrations.reduce((sum, d) => sum + d.duration, 0) / demonstrations.length;
    replace(
      this.at("demonstrations"),
      element("p", { class: "count" }, element("strong", {}, String(demonstrations.length)), ` ${plural(demonstrations.length, "demonstration")}`),
      facts([
        ["Clean", String(count("clean"))],
        ["Repaired", count("repaired") && String(count("repaired"))],
        ["Not usable", count("reject") && String(count("reject"))],
        ["Mean transport", number(mean, 1, "s")],
        ["Samples lost", String(demonstrations.reduce((sum, d) => sum + (d.account?.lost ?? 0), 0))],
      ]),
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
