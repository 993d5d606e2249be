// Past executions: what the arm did, as curves and as a ghost, at any instant.
import { at, get } from "../api.js";
import { Ghost } from "../arm/ghost.js";
import { Motion, play } from "../arm/motion.js";
import { Plots, row } from "../arm/plots.js";
import { element, hint, number, replace, sentence } from "../elements.js";

const POINTS = 1500; // at most, of the curves
const LISTED = 20;

export function replay(place, context) {
  const panel = new ReplayPanel(place, context);
  return { update: (state, changed) => panel.update(state, changed), hide: () => panel.close(), panel };
}

class ReplayPanel {
  constructor(place, context) {
    Object.assign(this, { place, context });
    this.list = element("ol", { class: "executions", "aria-label": "executions, newest first" });
    this.scrub = element("input", { type: "range", min: "0", step: "0.01", value: "0", "aria-label": "Instant of the execution" });
    this.words = element("output", { class: "words" });
    this.play = element("button", { type: "button" }, "Play");
    const shut = element("button", { type: "button" }, "Close replay");
    this.curves = element("div", {});
    this.bench = element("div", { class: "scrub", hidden: "" }, this.scrub, this.words, element("p", { class: "orders" }, this.play, shut), this.curves);
    place.append(this.list, this.bench);
    this.list.addEventListener("click", (event) => {
      const { execution } = event.target.closest("button")?.dataset ?? {};
      if (execution) context.attempt(() => this.#open(execution));
    });
    shut.addEventListener("click", () => this.close());
    this.play.addEventListener("click", () => (this.stop ? this.#pause() : this.#start()));
    this.scrub.addEventListener("input", () => {
      this.#pause();
      this.#show(Number(this.scrub.value));
    });
  }

  update(state, changed) {
    if (changed.has("executions")) this.#paint(state.executions);
  }

  close() {
    this.#pause();
    this.ghost?.remove();
    this.ghost = this.motion = null;
    this.bench.hidden = true;
    this.execution = "";
    this.#paint(this.context.store.state.executions);
  }

  async #open(execution) {
    const [rows, arm, plan] = await Promise.all([get(`${at("executions", execution, "series")}?points=${POINTS}`), get("robot"), this.#plan(execution)]);
    if (rows.times.length < 2) {
      this.context.messages.say("Nothing was recorded of this execution: the arm did not begin to move.", "error");
      return;
    }
    this.close();
    const begin = rows.times[0];
    const times = rows.times.map((time) => time - begin);
    this.motion = new Motion({ times, joints: rows.positions, gripper_closed: rows.gripper_closed, object_position: rows.object, object_orientation: rows.object.map(() => [1, 0, 0, 0]) });
    this.ghost = new Ghost(this.context.easel, this.context.view, arm, rows.object.length ? plan?.scene.carried : null);
    this.execution = execution;
    this.bench.hidden = false;
    this.plots ??= new Plots(this.curves);
    const entry = (time, i) => ({ time, position: rows.positions[i], speed: rows.velocities[i], error: rows.tracking_error[i], lateness: rows.lateness[i] });
    this.plots.set(times.map((time, i) => row(arm, entry(time, i))));
    this.scrub.max = String(this.motion.duration);
    this.#paint(this.context.store.state.executions);
    this.#show(0);
  }

  // The plan that it followed, for the shape of what was carried; it may be gone.
  #plan(execution) {
    const plan = this.context.store.state.executions?.find((one) => one.id === execution)?.plan;
    return plan ? get(at("plans", plan)).catch(() => null) : null;
  }

  #start() {
    const { duration } = this.motion;
    const from = Number(this.scrub.value) >= duration - 0.01 ? 0 : Number(this.scrub.value);
    this.stop = play(from, duration, (seconds) => this.#show(seconds), () => this.#pause());
    this.play.textContent = "Pause";
  }

  #pause() {
    this.stop?.();
    this.stop = null;
    this.play.textContent = "Play";
  }

  #show(seconds) {
    const here = this.motion.at(seconds);
    this.ghost.place(here.q, here);
    this.plots.mark(seconds);
    this.scrub.value = String(seconds);
    const words = `${number(seconds, 1, "s")} of ${number(this.motion.duration, 1, "s")}`;
    this.scrub.setAttribute("aria-valuetext", words);
    this.words.textContent = words;
  }

  #paint(executions) {
    if (!executions?.length) {
      replace(this.list, hint("Nothing has been executed yet. What the arm does is kept and can be looked at here."));
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
