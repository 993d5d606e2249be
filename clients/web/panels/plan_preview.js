// Preview: the plan of the chosen path as a ghost in the view, before anything moves.
import { at, get, post } from "../api.js";
import { Ghost } from "../arm/ghost_arm.js";
import { Motion } from "../arm/motion.js";
import { Player } from "../arm/motion_player.js";
import { bar, element, facts, hint, next, number, percent, replace } from "../elements.js";
import { pathOf } from "../store.js";

export function preview(place, context) {
  const panel = new PreviewPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.hide(), player: panel.player };
}

class PreviewPanel {
  plan = null; // the newest of the path that is looked at; null: there is none; undefined: not known yet
  #fetched = 0; // questions so far: only the newest one's answer counts
  #opened = 0;

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.facts = element("div", {});
    this.open = element("button", { type: "button", class: "primary" }, "Preview");
    this.make = element("button", { type: "button", class: "primary" }, "Plan the motion");
    this.player = new Player({ instant: "Instant of the motion", shut: "Close preview", shown: (_, here) => here.words, closed: () => this.#paint() });
    place.append(this.facts, element("p", { class: "orders" }, this.make, this.open), this.player.element);
    this.make.addEventListener("click", () => this.#plan());
    this.open.addEventListener("click", () => context.attempt(() => this.#open()));
    this.#paint();
  }

  update(state, changed) {
    if (!["runs", "run", "path", "jobs", "task"].some((name) => changed.has(name))) return;
    const path = pathOf(state);
    const planned = (state.jobs ?? []).filter((job) => job.kind === "plan" && job.request?.path === path?.id);
    this.job = planned.at(-1) ?? null;
    const key = path ? `${path.id} ${planned.filter((job) => job.state === "succeeded").length}` : "";
    if (key !== this.key || changed.has("runs")) {
      this.key = key;
      this.#fetch(path);
    }
    this.#paint();
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
    const read = (...pieces) => (path ? get(at("paths", path.id, ...pieces)).catch(() => null) : null);
    const [plans, newest] = await Promise.all([read("plans"), read()]);
    if (turn !== this.#fetched) return; // another one was chosen meanwhile, or planned again
    this.plan = plans?.[0] ?? null;
    this.newest = newest?.version;
    if (this.plan?.id !== before) this.player.close();
    this.context.store.set({ plan: this.plan });
    this.#paint();
  }

  #plan() {
    const { path, context } = this;
    context.attempt(async () => {
      await post(at("paths", path.id, "plans"));
      await context.feed.read("jobs");
    });
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  async #open() {
    const turn = ++this.#opened;
    const { plan, context } = this;
    const [rows, arm] = await Promise.all([get(at("plans", plan.id, "motion")), get("robot")]);
    if (turn !== this.#opened || plan !== this.plan || this.player.motion) return; // left meanwhile, or it is another plan
    this.player.open(new Motion(rows), new Ghost(context.easel, context.view, arm, plan.scene.carried));
    this.#paint();
    this.player.start();
  }

  #paint() {
    const { plan, path, job, newest } = this;
    const working = job?.state === "queued" || job?.state === "running";
    const newer = plan && newest > plan.path_version && newest;
    replace(this.facts, content(path, plan, job, working, newer));
    this.make.hidden = !path || plan === undefined || (plan !== null && !newer) || working;
    this.make.textContent = newer ? `Plan version ${newer}` : "Plan the motion";
    this.open.hidden = !plan || Boolean(this.player.motion);
  }
}

function content(path, plan, job, working, newer) {
  if (!path) return [hint("Nothing to run yet. Show a task, learn its ways and choose one: its motion is planned and certified before the arm may move."), next("ways", "Go to the ways")];
  const who = element("p", {}, `Way ${path.cluster}${plan ? `, version ${plan.path_version}` : ""}.`);
  if (working) return [who, element("p", { class: "hint" }, job.message || "Planning …"), bar(job.fraction, "planning")];
  if (plan === undefined) return [who, hint("Looking for its certified motion …")];
  if (!plan) {
    const why = job?.state === "failed" && element("p", { class: "failed" }, `It cannot be run: ${job.message}`);
    return why ? [who, why, next("edit", "Edit the path")] : [who, hint("This path has no certified motion yet.")];
  }
  const { certificate } = plan;
  const uses = ["position_use", "velocity_use", "acceleration_use", "jerk_use", "torque_use"].map((name) => certificate[name]);
  const most = uses.reduce((a, b) => (a.value >= b.value ? a : b));
  return [
    who,
    newer && hint(`Version ${newer} is newer and not certified yet.`),
    facts([
      ["Time on the path", number(plan.duration, 2, "s")],
      ["Least clearance", number(1000 * certificate.clearance.value, 0, "mm")],
      ["Nearest to a limit", `${percent(most.value)}, ${most.place}`],
      ["Posture of the arm", certificate.branch],
    ]),
  ];
}
