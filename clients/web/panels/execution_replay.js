// Past executions: what the arm did at any instant, as plots and by a ghost arm.
import { get, resourcePath } from "../api.js";
import { GhostArm } from "../arm/ghost_arm.js";
import { JointPlots, plotRow } from "../arm/joint_plots.js";
import { Motion } from "../arm/motion.js";
import { MotionPlayer } from "../arm/motion_player.js";
import { closestData, element } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { ofShownStation, StationWatch, stationLabels } from "../stations.js";
import { capitalize, formatNumber } from "../texts.js";
import { PlanNames } from "./plan_names.js";
import { executionMenu } from "./program_menu.js";

const MAX_POINTS = 1500; // of the plots
const MAX_LISTED = 20;
const NO_EXECUTIONS_SENTENCE = "Nothing has been executed yet. What the arm does is kept and can be looked at here.";

/** @param {HTMLElement} place @param {Context} context */
export function executionReplay(place, context) {
  const panel = new ExecutionReplay(place, context);
  return {
    /** @type {Section["update"]} */
    update: (state, changed) => panel.update(state, changed),
    hide: () => panel.hide(),
    player: panel.player,
  };
}

class ExecutionReplay {
  #opened = 0; // executions that were asked for: only the newest one is shown
  #execution = ""; // id of the one that is shown
  /** @type {JointPlots | null} */
  #plots = null;
  #names = new PlanNames();
  #watch = new StationWatch();

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.list = element("ol", { class: "executions", "aria-label": "executions, newest first" });
    this.curves = element("div", {});
    this.files = element("div", {});
    this.player = new MotionPlayer({
      sliderLabel: "Instant of the execution",
      closeLabel: "Close replay",
      children: [this.curves, this.files],
      describe: (seconds) => {
        this.#plots?.setCursor(seconds);
        return "";
      },
      onClose: () => this.#select(""),
    });
    place.append(this.list, this.player.element);
    this.list.addEventListener("click", (event) => {
      const { execution } = closestData(event);
      if (execution) context.attempt(() => this.#open(execution));
    });
  }

  /** @param {State} state @param {Changed} changed */
  update(state, changed) {
    if (!this.#watch.hasChanged(state, changed) && !changed.has("executions")) return;
    this.#render(state);
    this.#readNames(state.executions ?? []);
  }

  /** @param {Execution[]} executions */
  async #readNames(executions) {
    const plans = executions.slice(0, MAX_LISTED).flatMap(({ plan }) => (plan ? [plan] : []));
    if (await this.#names.read(plans, this.context.store.state.tasks)) this.#render(this.context.store.state);
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  /** @param {string} execution */
  #select(execution) {
    this.#execution = execution;
    this.#render(this.context.store.state);
  }

  /** @param {string} execution */
  async #open(execution) {
    const turn = ++this.#opened;
    /** @type {[TimeSeries, Robot, Plan | null]} */
    const [series, arm, plan] = await Promise.all([
      get(`${resourcePath("executions", execution, "series")}?points=${MAX_POINTS}`),
      get("robot"),
      this.#readPlan(execution),
    ]);
    if (turn !== this.#opened) return; // another one was chosen meanwhile, or the tab was left
    if (series.times.length < 2) {
      this.context.messages.show("Nothing was recorded of this execution: the arm did not begin to move.", "error");
      return;
    }
    const carried = series.object.length ? (plan?.scene.carried ?? null) : null;
    const ghost = new GhostArm(this.context.overlay, this.context.view, arm, carried);
    this.player.open(motionOf(series), ghost);
    this.#plots ??= new JointPlots(this.curves, arm);
    this.#plots.set(plotRows(series, arm));
    this.files.replaceChildren(executionMenu(execution, this.context.attempt));
    this.#select(execution);
    this.player.show(0);
  }

  /**
   * The plan that it followed, for the shape of what was carried; it may be gone.
   * @param {string} execution
   */
  #readPlan(execution) {
    const plan = this.context.store.state.executions?.find((one) => one.id === execution)?.plan;
    return plan ? get(resourcePath("plans", plan)).catch(() => null) : null;
  }

  /** @param {State} state */
  #render(state) {
    const newest = ofShownStation(state, state.executions).slice(0, MAX_LISTED);
    const stationOf = stationLabels(state);
    const rows = newest.map((one) =>
      executionRow(one, this.#names.of(one.plan), one.id === this.#execution, stationOf(one)),
    );
    patchChildren(this.list, rows.length ? rows : element("li", { class: "hint" }, NO_EXECUTIONS_SENTENCE));
  }
}

/** @param {TimeSeries} series */
function motionOf({ times, positions, gripper_closed, object }) {
  return new Motion({
    times: times.map((time) => time - times[0]),
    joints: positions,
    gripper_closed,
    object_position: object,
    object_orientation: object.map(() => [1, 0, 0, 0]),
  });
}

/** @param {TimeSeries} series @param {Robot} arm */
function plotRows({ times, positions, velocities, tracking_error, lateness }, arm) {
  return times.map((time, i) =>
    plotRow(arm, {
      time: time - times[0],
      position: positions[i],
      speed: velocities[i],
      error: tracking_error[i],
      lateness: lateness[i],
    }),
  );
}

/**
 * @param {Execution} execution
 * @param {string} name of what was executed
 * @param {boolean} open
 * @param {string} station whose arm moved, where there are several
 */
function executionRow({ id, plan, created_ns, status }, name, open, station) {
  const digits = /** @type {const} */ ({ hour: "2-digit", minute: "2-digit", second: "2-digit" });
  const when = new Date(created_ns / 1e6).toLocaleTimeString([], { ...digits, hour12: false });
  const time = status.duration > 0 ? ` after ${formatNumber(status.duration, 1, "s")}` : "";
  const reason = status.reason ? `: ${status.reason}` : "";
  const label = { "aria-label": `Replay the execution of ${when}${name && `: ${name}`}`, "aria-pressed": String(open) };
  return element(
    "li",
    { class: open ? "open" : "" },
    element("span", {}, when),
    element(
      "span",
      { class: "why" },
      plan ? name && `${capitalize(name)}. ` : "A live hand. ",
      `${capitalize(status.state)}${station && ` at ${station}`}${time}${reason}`,
    ),
    element("button", { type: "button", "data-execution": id, "data-key": id, ...label }, "Replay"),
  );
}
