// The plan of the selected path, shown by a ghost arm before anything moves.
import { get, post, resourcePath } from "../api.js";
import { GhostArm } from "../arm/ghost_arm.js";
import { Motion } from "../arm/motion.js";
import { MotionPlayer } from "../arm/motion_player.js";
import {
  definitionList,
  element,
  formatNumber,
  formatPercent,
  hint,
  patchChildren,
  progressBar,
  tabButton,
} from "../elements.js";
import { selectedPath } from "../store.js";

export function planPreview(place, context) {
  const panel = new PlanPreview(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.hide(), player: panel.player };
}

class PlanPreview {
  plan = null; // the newest of the path that is looked at; null: there is none; undefined: not known yet
  #fetched = 0; // questions so far: only the newest one's answer counts
  #opened = 0;

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.facts = element("div", {});
    this.previewButton = element("button", { type: "button", class: "primary" }, "Preview");
    this.planButton = element("button", { type: "button", class: "primary" }, "Plan the motion");
    this.player = new MotionPlayer({
      sliderLabel: "Instant of the motion",
      closeLabel: "Close preview",
      describe: (_, here) => here.segment,
      onClose: () => this.#render(),
    });
    place.append(
      this.facts,
      element("p", { class: "buttons" }, this.planButton, this.previewButton),
      this.player.element,
    );
    this.planButton.addEventListener("click", () => this.#plan());
    this.previewButton.addEventListener("click", () => context.attempt(() => this.#openPreview()));
    this.#render();
  }

  update(state, changed) {
    if (!["runs", "run", "path", "jobs", "task"].some((name) => changed.has(name))) return;
    const path = selectedPath(state);
    const planned = (state.jobs ?? []).filter((job) => job.kind === "plan" && job.request?.path === path?.id);
    this.job = planned.at(-1) ?? null;
    const key = path ? `${path.id} ${planned.filter((job) => job.state === "succeeded").length}` : "";
    if (key !== this.key || changed.has("runs")) {
      this.key = key;
      this.#fetch(path);
    }
    this.#render();
  }

  // The newest plan of the path, of whatever version: only what is certified can be run.
  async #fetch(path) {
    const turn = ++this.#fetched;
    const before = this.plan?.id;
    if (path?.id !== this.path?.id) {
      this.plan = undefined; // nobody starts the former path's plan meanwhile
      this.context.store.set({ plan: null });
      this.player.close();
    }
    this.path = path;
    const read = (...pieces) => (path ? get(resourcePath("paths", path.id, ...pieces)).catch(() => null) : null);
    const [plans, newest] = await Promise.all([read("plans"), read()]);
    if (turn !== this.#fetched) return; // another one was chosen meanwhile, or planned again
    this.plan = plans?.[0] ?? null;
    this.newest = newest?.version;
    if (this.plan?.id !== before) this.player.close();
    this.context.store.set({ plan: this.plan });
    this.#render();
  }

  #plan() {
    const { path, context } = this;
    context.attempt(async () => {
      await post(resourcePath("paths", path.id, "plans"));
      await context.eventStream.read("jobs");
    });
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  async #openPreview() {
    const turn = ++this.#opened;
    const { plan, context } = this;
    const [rows, arm] = await Promise.all([get(resourcePath("plans", plan.id, "motion")), get("robot")]);
    if (turn !== this.#opened || plan !== this.plan || this.player.motion) return; // left meanwhile, or it is another plan
    this.player.open(new Motion(rows), new GhostArm(context.overlay, context.view, arm, plan.scene.carried));
    this.#render();
    this.player.start();
  }

  #render() {
    const { plan, path, job, newest } = this;
    const working = job?.state === "queued" || job?.state === "running";
    const newer = plan && newest > plan.path_version && newest;
    patchChildren(this.facts, content(path, plan, job, working, newer));
    this.planButton.hidden = !path || plan === undefined || (plan !== null && !newer) || working;
    this.planButton.textContent = newer ? `Plan version ${newer}` : "Plan the motion";
    this.previewButton.hidden = !plan || Boolean(this.player.motion);
  }
}

function content(path, plan, job, working, newer) {
  if (!path)
    return [
      hint(
        "Nothing to run yet. Show a task, learn its ways and choose one: its motion is planned and certified before the arm may move.",
      ),
      tabButton("ways", "Go to the ways"),
    ];
  const who = element("p", {}, `Way ${path.cluster}${plan ? `, version ${plan.path_version}` : ""}.`);
  if (working)
    return [who, element("p", { class: "hint" }, job.message || "Planning …"), progressBar(job.fraction, "planning")];
  if (plan === undefined) return [who, hint("Looking for its certified motion …")];
  if (!plan) {
    const why = job?.state === "failed" && element("p", { class: "failed" }, `It cannot be run: ${job.message}`);
    return why ? [who, why, tabButton("edit", "Edit the path")] : [who, hint("This path has no certified motion yet.")];
  }
  const { certificate } = plan;
  const uses = ["position_use", "velocity_use", "acceleration_use", "jerk_use", "torque_use"].map(
    (name) => certificate[name],
  );
  const most = uses.reduce((a, b) => (a.value >= b.value ? a : b));
  return [
    who,
    newer && hint(`Version ${newer} is newer and not certified yet.`),
    definitionList([
      ["Time on the path", formatNumber(plan.duration, 2, "s")],
      ["Least clearance", formatNumber(1000 * certificate.clearance.value, 0, "mm")],
      ["Nearest to a limit", `${formatPercent(most.value)}, ${most.place}`],
      ["Posture of the arm", certificate.branch],
    ]),
  ];
}
