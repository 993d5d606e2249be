// Past executions: what the arm did, as curves and as a ghost, at any instant.
import { at, get } from "../api.js";
import { Ghost } from "../arm/ghost_arm.js";
import { Motion } from "../arm/motion.js";
import { Player } from "../arm/motion_player.js";
import { Plots, row } from "../arm/joint_plots.js";
import { element, number, replace, sentence } from "../elements.js";

const POINTS = 1500; // at most, of the curves
const LISTED = 20;

export function replay(place, context) {
  const panel = new ReplayPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.hide(), player: panel.player };
}

class ReplayPanel {
  #opened = 0; // executions that were asked for: only the newest one is shown

  constructor(place, context) {
    Object.assign(this, { place, context });
    this.list = element("ol", { class: "executions", "aria-label": "executions, newest first" });
    this.curves = element("div", {});
    this.player = new Player({ instant: "Instant of the execution", shut: "Close replay", more: [this.curves], shown: (seconds) => this.#mark(seconds), closed: () => this.#choose("") });
    place.append(this.list, this.player.element);
    this.list.addEventListener("click", (event) => {
      const { execution } = event.target.closest("button")?.dataset ?? {};
      if (execution) context.attempt(() => this.#open(execution));
    });
  }

  update(state, changed) {
    if (changed.has("executions")) this.#paint(state.executions);
  }

  #choose(execution) {
    this.execution = execution;
    this.#paint(this.context.store.state.executions);
  }

  #mark(seconds) {
    this.plots.mark(seconds);
    return "";
  }

  hide() {
    this.#opened += 1;
    this.player.close();
  }

  async #open(execution) {
    const turn = ++this.#opened;
    const [rows, arm, plan] = await Promise.all([get(`${at("executions", execution, "series")}?points=${POINTS}`), get("robot"), this.#plan(execution)]);
    if (turn !== this.#opened) return; // another one was chosen meanwhile, or the tab was left
    if (rows.times.length < 2) {
      this.context.messages.say("Nothing was recorded of this execution: the arm did not begin to move.", "error");
      return;
    }
    const begin = rows.times[0];
    const times = rows.times.map((time) => time - begin);
    const motion = new Motion({ times, joints: rows.positions, gripper_closed: rows.gripper_closed, object_position: rows.object, object_orientation: rows.object.map(() => [1, 0, 0, 0]) });
    this.player.open(motion, new Ghost(this.context.easel, this.context.view, arm, rows.object.length ? plan?.scene.carried : null));
    this.plots ??= new Plots(this.curves);
    const entry = (time, i) => ({ time, position: rows.positions[i], speed: rows.velocities[i], error: rows.tracking_error[i], lateness: rows.lateness[i] });
    this.plots.set(times.map((time, i) => row(arm, entry(time, i))));
    this.#choose(execution);
    this.player.show(0);
  }

  // The plan that it followed, for the shape of what was carried; it may be gone.
  #plan(execution) {
    const plan = this.context.store.state.executions?.find((one) => one.id === execution)?.plan;
    return plan ? get(at("plans", plan)).catch(() => null) : null;
  }

  #paint(executions) {
    if (!executions?.length) {
      replace(this.list, element("li", { class: "hint" }, "Nothing has been executed yet. What the arm does is kept and can be looked at here."));
      return;
    }
    replace(this.list, executions.slice(0, LISTED).map((one) => line(one, one.id === this.execution)));
  }
}

function line({ id, created_ns, status }, open) {
  const when = new Date(created_ns / 1e6).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit", second: "2-digit", hour12: false });
  return element(
    "li",
    { class: open ? "open" : "" },
    element("span", {}, when),
    element("span", { class: "why" }, `${sentence(status.state)}${status.duration > 0 ? ` after ${number(status.duration, 1, "s")}` : ""}${status.reason ? `: ${status.reason}` : ""}`),
    element("button", { type: "button", "data-execution": id, "data-key": id, "aria-label": `Replay the execution of ${when}`, "aria-pressed": String(open) }, "Replay"),
  );
}
