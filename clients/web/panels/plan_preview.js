// The plan of the selected path, shown by a ghost arm before anything moves.
import { get, post, resourcePath } from "../api.js";
import { GhostArm } from "../arm/ghost_arm.js";
import { Motion } from "../arm/motion.js";
import { MotionPlayer } from "../arm/motion_player.js";
import { definitionList, element, hint, progressBar, tabButton } from "../elements.js";
import { icon } from "../icons.js";
import { patchChildren } from "../patch_children.js";
import { changesAny, selectedPath } from "../store.js";
import { formatLength, formatNumber, formatPercent } from "../texts.js";
import { planMenu } from "./program_menu.js";

const NO_PLAN_SENTENCE =
  "Nothing to run yet. Show a task, learn its ways and choose one: its motion is planned and certified before the arm may move.";

/** @param {HTMLElement} place @param {Context} context */
export function planPreview(place, context) {
  const panel = new PlanPreview(place, context);
  return {
    /** @type {Section["update"]} */
    update: (state, changed) => panel.update(state, changed),
    hide: () => panel.hide(),
    player: panel.player,
  };
}

class PlanPreview {
  /** @type {Plan | null | undefined} */
  #plan = null; // the newest of the path that is looked at; null: there is none; undefined: not known yet
  /** @type {LearnedPath | null} */
  #path = null;
  /** @type {Job | null} */
  #job = null; // the newest that plans it
  #newestVersion = 0; // of the path
  #key = "";
  #fetched = 0; // requests so far: only the newest one's answer counts
  #opened = 0;
  /** @type {string | undefined} */
  #offered; // id of the plan whose files the menu offers

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.facts = element("div", {});
    this.previewButton = element("button", { type: "button" }, icon("preview"), "Preview");
    this.planButton = element("button", { type: "button", class: "primary" }, "Plan the motion");
    this.player = new MotionPlayer({
      sliderLabel: "Instant of the motion",
      closeLabel: "Close preview",
      describe: (_, { segment }) => segment,
      onClose: () => this.#render(),
    });
    const buttons = element("p", { class: "buttons" }, this.planButton, this.previewButton);
    this.programs = element("div", {});
    place.append(this.facts, buttons, this.programs, this.player.element);
    this.planButton.addEventListener("click", () => context.attempt(() => this.#requestPlan()));
    this.previewButton.addEventListener("click", () => context.attempt(() => this.#openPreview()));
    this.#render();
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (!changesAny(changed, "runs", "selectedRun", "path", "jobs", "task")) return;
    const path = selectedPath(state);
    const planned = (state.jobs ?? []).filter((job) => job.kind === "plan" && job.request.path === path?.id);
    this.#job = planned[0] ?? null;
    const key = path ? `${path.id} ${planned.filter((job) => job.state === "succeeded").length}` : "";
    if (key !== this.#key || changed.has("runs")) {
      this.#key = key;
      this.#fetch(path);
    }
    this.#render();
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  /**
   * Read the newest plan of the path, of whatever version: only what is certified can be run.
   * @param {LearnedPath | null} path
   */
  async #fetch(path) {
    const request = ++this.#fetched;
    const before = this.#plan?.id;
    if (path?.id !== this.#path?.id) {
      this.#plan = undefined; // nobody starts the former path's plan meanwhile
      this.context.store.set({ plan: null });
      this.#showPrograms();
      this.player.close();
    }
    this.#path = path;
    const place = path && resourcePath("paths", path.id);
    /** @type {[Plan[] | null, LearnedPath | null]} */
    const [plans, newest] = place
      ? await Promise.all([get(`${place}/plans?limit=1`).catch(() => null), get(place).catch(() => null)])
      : [null, null];
    if (request !== this.#fetched) return; // another one was chosen meanwhile, or planned again
    this.#plan = plans?.[0] ?? null;
    this.#newestVersion = newest?.version ?? 0;
    if (this.#plan?.id !== before) this.player.close();
    this.context.store.set({ plan: this.#plan });
    this.#showPrograms();
    this.#render();
  }

  #showPrograms() {
    const plan = this.context.readOnly ? null : this.#plan;
    if (plan?.id === this.#offered) return; // an open menu stays open
    this.#offered = plan?.id;
    this.programs.replaceChildren(...(plan ? [planMenu(plan.id, this.context.attempt)] : []));
  }

  async #requestPlan() {
    if (!this.#path) return;
    await post(resourcePath("paths", this.#path.id, "plans"));
    await this.context.eventStream.read("jobs");
  }

  async #openPreview() {
    const request = ++this.#opened;
    const plan = this.#plan;
    if (!plan) return;
    const { overlay, view } = this.context;
    /** @type {[MotionPreview, Robot]} */
    const [rows, arm] = await Promise.all([get(resourcePath("plans", plan.id, "motion")), get("robot")]);
    if (request !== this.#opened || plan !== this.#plan || this.player.motion) return; // left, or it is another plan
    this.player.open(new Motion(rows), new GhostArm(overlay, view, arm, plan.scene.carried));
    this.#render();
    this.player.start();
  }

  #render() {
    const [plan, path, job] = [this.#plan, this.#path, this.#job];
    const working = job?.state === "queued" || job?.state === "running";
    const newer = plan && this.#newestVersion > plan.path_version ? this.#newestVersion : 0;
    patchChildren(
      this.facts,
      path
        ? content(path, plan, job, newer, this.context.readOnly)
        : [hint(NO_PLAN_SENTENCE), tabButton("ways", "Go to the ways")],
    );
    const wanted = path !== null && (plan === null || newer > 0) && !working && !this.context.readOnly;
    this.planButton.hidden = !wanted;
    this.planButton.textContent = newer ? `Plan version ${newer}` : "Plan the motion";
    this.previewButton.hidden = !plan || Boolean(this.player.motion);
  }
}

/**
 * @param {LearnedPath} path
 * @param {Plan | null | undefined} plan
 * @param {Job | null} job
 * @param {number} newer version that is not certified yet, or 0
 * @param {boolean} readOnly
 * @returns {Child[]}
 */
function content(path, plan, job, newer, readOnly) {
  const title = element("p", {}, `Way ${path.cluster}${plan ? `, version ${plan.path_version}` : ""}.`);
  if (job?.state === "queued" || job?.state === "running") {
    return [title, hint(job.message || "Planning …"), progressBar(job.fraction, "planning")];
  }
  if (plan === undefined) return [title, hint("Looking for its certified motion …")];
  if (plan) return [title, newer > 0 && hint(`Version ${newer} is newer and not certified yet.`), planFacts(plan)];
  if (job?.state !== "failed") return [title, hint("This path has no certified motion yet.")];
  const why = element("p", { class: "failed" }, `It cannot be run: ${job.message}`);
  return [title, why, !readOnly && tabButton("edit", "Edit the path")];
}

/** @param {Plan} plan */
function planFacts({ duration, certificate, tool_speed: limit, posture, output, author }) {
  const { position_use, velocity_use, acceleration_use, jerk_use, torque_use } = certificate;
  const uses = [position_use, velocity_use, acceleration_use, jerk_use, torque_use];
  const toolSpeed = certificate.tool_speed;
  const most = uses.reduce((a, b) => (a.value >= b.value ? a : b));
  return definitionList([
    ["Time on the path", formatNumber(duration, 2, "s")],
    ["Least clearance", formatLength(certificate.clearance.value)],
    ["Nearest to a limit", `${formatPercent(most.value)}, ${most.place}`],
    toolSpeed && [
      "Fastest",
      `${formatNumber(toolSpeed.value, 2, "m/s")}, ${toolSpeed.place}${limit ? `; limit ${formatNumber(limit, 2, "m/s")}` : ""}`,
    ],
    ["Posture of the arm", certificate.branch],
    output && [
      "Output",
      `${output.name}, on along the path; rests ${formatNumber(output.start, 1, "s")} before it and ${formatNumber(output.end, 1, "s")} behind it with it on`,
    ],
    posture && [
      "Farthest from what the arm showed",
      `${formatNumber((180 * posture.distance.value) / Math.PI, 1, "°")}, ${posture.distance.place}`,
    ],
    ["Planned for", author],
  ]);
}
