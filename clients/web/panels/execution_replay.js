// Past executions: what the arm did at any instant, as plots and by a ghost arm.
import { get, resourcePath } from "../api.js";
import { GhostArm } from "../arm/ghost_arm.js";
import { JointPlots, plotRow } from "../arm/joint_plots.js";
import { Motion } from "../arm/motion.js";
import { MotionPlayer } from "../arm/motion_player.js";
import { capitalize, element, formatNumber, patchChildren } from "../elements.js";

const MAX_POINTS = 1500; // at most, of the curves
const MAX_LISTED = 20;

export function executionReplay(place, context) {
  const panel = new ExecutionReplay(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.hide(), player: panel.player };
}

class ExecutionReplay {
  #opened = 0; // executions that were asked for: only the newest one is shown

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.list = element("ol", { class: "executions", "aria-label": "executions, newest first" });
    this.curves = element("div", {});
    this.player = new MotionPlayer({
      sliderLabel: "Instant of the execution",
      closeLabel: "Close replay",
      children: [this.curves],
      describe: (seconds) => this.#setCursor(seconds),
      onClose: () => this.#select(""),
    });
    place.append(this.list, this.player.element);
    this.list.addEventListener("click", (event) => {
      const { execution } = event.target.closest("button")?.dataset ?? {};
      if (execution) context.attempt(() => this.#open(execution));
    });
  }

  update(state, changed) {
    if (changed.has("executions")) this.#render(state.executions);
  }

  #select(execution) {
    this.execution = execution;
    this.#render(this.context.store.state.executions);
  }

  #setCursor(seconds) {
    this.plots.setCursor(seconds);
    return "";
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  async #open(execution) {
    const turn = ++this.#opened;
    const [rows, arm, plan] = await Promise.all([
      get(`${resourcePath("executions", execution, "series")}?points=${MAX_POINTS}`),
      get("robot"),
      this.#plan(execution),
    ]);
    if (turn !== this.#opened) return; // another one was chosen meanwhile, or the tab was left
    if (rows.times.length < 2) {
      this.context.messages.show("Nothing was recorded of this execution: the arm did not begin to move.", "error");
      return;
    }
    const begin = rows.times[0];
    const times = rows.times.map((time) => time - begin);
    const motion = new Motion({
      times,
      joints: rows.positions,
      gripper_closed: rows.gripper_closed,
      object_position: rows.object,
      object_orientation: rows.object.map(() => [1, 0, 0, 0]),
    });
    this.player.open(
      motion,
      new GhostArm(this.context.overlay, this.context.view, arm, rows.object.length ? plan?.scene.carried : null),
    );
    this.plots ??= new JointPlots(this.curves);
    const entry = (time, i) => ({
      time,
      position: rows.positions[i],
      speed: rows.velocities[i],
      error: rows.tracking_error[i],
      lateness: rows.lateness[i],
    });
    this.plots.set(times.map((time, i) => plotRow(arm, entry(time, i))));
    this.#select(execution);
    this.player.show(0);
  }

  // The plan that it followed, for the shape of what was carried; it may be gone.
  #plan(execution) {
    const plan = this.context.store.state.executions?.find((one) => one.id === execution)?.plan;
    return plan ? get(resourcePath("plans", plan)).catch(() => null) : null;
  }

  #render(executions) {
    if (!executions?.length) {
      patchChildren(
        this.list,
        element(
          "li",
          { class: "hint" },
          "Nothing has been executed yet. What the arm does is kept and can be looked at here.",
        ),
      );
      return;
    }
    patchChildren(
      this.list,
      executions.slice(0, MAX_LISTED).map((one) => executionRow(one, one.id === this.execution)),
    );
  }
}

function executionRow({ id, created_ns, status }, open) {
  const when = new Date(created_ns / 1e6).toLocaleTimeString([], {
    hour: "2-digit",
    minute: "2-digit",
    second: "2-digit",
    hour12: false,
  });
  return element(
    "li",
    { class: open ? "open" : "" },
    element("span", {}, when),
    element(
      "span",
      { class: "why" },
      `${capitalize(status.state)}${status.duration > 0 ? ` after ${formatNumber(status.duration, 1, "s")}` : ""}${status.reason ? `: ${status.reason}` : ""}`,
    ),
    element(
      "button",
      {
        type: "button",
        "data-execution": id,
        "data-key": id,
        "aria-label": `Replay the execution of ${when}`,
        "aria-pressed": String(open),
      },
      "Replay",
    ),
  );
}
