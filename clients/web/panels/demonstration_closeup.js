// One demonstration over time, with handles that trim it; and beside another one, with the distance between them.
import { get, patch, resourcePath } from "../api.js";
import { block, closestData, element, hint, option } from "../elements.js";
import { listenForMarks } from "../files/mark_input.js";
import { motionPlot } from "../files/motion_plot.js";
import { LinePlot } from "../line_plot.js";
import { patchChildren } from "../patch_children.js";
import { formatLength, formatNumber } from "../texts.js";
import { trimKey } from "../trajectory_cache.js";
import { compareMotions, overShare, trimmedSamples } from "./demonstration_comparison.js";

const CLOSEUP_HELP =
  "Say the number of a demonstration, to trim it; and that of another one, to see both over time. Nothing of the recording is lost.";
const MAX_POINTS = 2000; // points of a motion that are read
const [AXIS_HEIGHT, DISTANCE_HEIGHT] = [84, 110]; // [px]
const LINES = { one: "closeup-one", other: "closeup-other" };

/** @typedef {import("./demonstration_comparison.js").Motion} Motion */
/** @typedef {{id: string, key: string, motion: Motion}} Read a motion that was read, and the cut that it has */

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function demonstrationCloseup(place, context) {
  if (context.readOnly) return { update: () => {} };
  const closeup = new Closeup(place, context);
  return {
    update(state, changed) {
      if (changed.has("task")) closeup.clear();
      if (changed.has("demonstrations")) closeup.read(state);
    },
    show: () => closeup.setShown(true),
    hide: () => closeup.setShown(false),
  };
}

class Closeup {
  #requests = 0; // only the newest one's answers count
  #isShown = true;
  /** @type {(Read | null)[]} */
  #motions = [null, null];
  /** @type {{grasp: number, release: number} | null} */
  #marks = null; // where the trim is to be [s]; null: as it is cut now
  /** @type {LinePlot[]} */
  #plots = [];

  /** @param {HTMLElement} place @param {Context} context */
  constructor(place, context) {
    this.context = context;
    this.numbers = ["closeup-one", "closeup-other"].map((id) =>
      element("input", { type: "text", inputmode: "numeric", id, size: 5, autocomplete: "off" }),
    );
    this.axis = element(
      "select",
      { id: "closeup-axis" },
      option("time", "seconds"),
      option("share", "the share of its time"),
    );
    const label = (/** @type {number} */ k, /** @type {string} */ text) =>
      element("label", { for: this.numbers[k].id }, text);
    const choice = element("p", { class: "field" }, label(0, "Demonstration"), this.numbers[0]);
    choice.append(label(1, "beside"), this.numbers[1]);
    this.over = element("p", { class: "field" }, element("label", { for: this.axis.id }, "Over"), this.axis);
    this.fault = element("p", { class: "note", role: "status" });
    this.plot = element("div", {});
    this.trim = element("button", { type: "button", "data-trim": "1" }, "Trim to the marks");
    this.whole = element("button", { type: "button", "data-whole": "1" }, "As it was recorded");
    this.buttons = element("p", { class: "buttons" }, this.trim, this.whole);
    this.comparison = element("div", {});
    this.facts = element("p", { class: "note", role: "status" });
    this.legend = element("p", { class: "note legend" });
    place.append(
      hint(CLOSEUP_HELP),
      choice,
      this.fault,
      this.plot,
      this.buttons,
      this.over,
      this.facts,
      this.legend,
      this.comparison,
    );
    for (const input of this.numbers) input.addEventListener("change", () => this.read(context.store.state));
    this.axis.addEventListener("change", () => this.#compare());
    place.addEventListener("click", (event) => {
      const { trim, whole } = closestData(event);
      if (trim) context.attempt(() => this.#trim());
      if (whole) context.attempt(() => this.#amend([0, 0], "is as it was recorded"));
    });
    listenForMarks(this.plot, {
      times: () => this.#motions[0]?.motion.times,
      marks: () => this.#shownMarks(),
      onMark: (_, mark, time) => this.#mark(mark, time),
    });
    this.#render();
  }

  clear() {
    for (const input of this.numbers) input.value = "";
    this.read(this.context.store.state);
  }

  /** @param {boolean} isShown */
  setShown(isShown) {
    this.#isShown = isShown;
    this.#draw();
  }

  /** Read the motions whose numbers are typed, where they are not here as they are cut now. @param {State} state */
  async read(state) {
    const request = ++this.#requests;
    const chosen = this.numbers.map((input) => this.#chosen(state, input.value.trim()));
    const read = chosen.map((demonstration, k) => this.#motionOf(demonstration, this.#motions[k]));
    // no attempt of the message line, which would clear the undo of a trim
    const motions = await Promise.all(read).catch(({ message }) => this.context.messages.show(message, "error"));
    if (!motions || request !== this.#requests) return;
    if (motions[0]?.key !== this.#motions[0]?.key) this.#marks = null;
    this.#motions = motions;
    this.#render();
  }

  /** @param {State} state @param {string} number */
  #chosen({ demonstrations }, number) {
    return demonstrations?.find((one) => String(one.number) === number) ?? null;
  }

  /** @param {Demonstration | null} demonstration @param {Read | null} known @returns {Promise<Read | null>} */
  async #motionOf(demonstration, known) {
    if (!demonstration) return null;
    const { id } = demonstration;
    const key = `${id} ${trimKey(demonstration)}`;
    if (known?.key === key) return known;
    return { id, key, motion: await get(`${resourcePath("demonstrations", id, "trajectory")}?most=${MAX_POINTS}`) };
  }

  get #demonstration() {
    const id = this.#motions[0]?.id;
    return this.context.store.state.demonstrations?.find((one) => one.id === id);
  }

  #shownMarks() {
    return this.#marks ?? { grasp: 0, release: this.#motions[0]?.motion.times.at(-1) ?? 0 };
  }

  /** @param {"grasp" | "release"} mark @param {number} time */
  #mark(mark, time) {
    const marks = { ...this.#shownMarks(), [mark]: time };
    if (marks.grasp < marks.release) this.#marks = marks;
    this.#render();
  }

  async #trim() {
    const [read, demonstration] = [this.#motions[0], this.#demonstration];
    if (!read || !demonstration || !this.#marks) return;
    const { grasp, release } = this.#marks;
    const span = `${formatNumber(grasp, 2)} to ${formatNumber(release, 2, "s")} of what it was`;
    await this.#amend(trimmedSamples(demonstration, read.motion.times, this.#marks), `goes from ${span}`);
  }

  /** @param {[number, number]} trim @param {string} outcome */
  async #amend(trim, outcome) {
    const demonstration = this.#demonstration;
    if (!demonstration) return;
    const { id, number, trim: before } = demonstration;
    const order = (/** @type {number[]} */ samples) => patch(resourcePath("demonstrations", id), { trim: samples });
    await order(trim);
    const undo = { label: "Undo", order: () => order(before ?? [0, 0]) };
    this.context.messages.show(`Demonstration ${number} ${outcome}.`, "note", undo);
  }

  #render() {
    const [read, demonstration] = [this.#motions[0], this.#demonstration];
    const unknown = this.numbers.filter((input, k) => input.value.trim() && !this.#motions[k]);
    this.fault.textContent = unknown.map(({ value }) => `There is no demonstration ${value.trim()}.`).join(" ");
    this.buttons.hidden = !read;
    const shown = read && { times: read.motion.times, positions: read.motion.positions, dwell_times: [] };
    patchChildren(this.plot, shown && motionPlot("closeup", /** @type {any} */ (shown), this.#shownMarks()));
    block(this.trim, this.#marks ? "" : "Move a mark first: press in the plot, or use the arrow keys on a mark.");
    block(this.whole, demonstration?.trim ? "" : "It is as it was recorded.");
    this.#compare();
    this.#draw();
  }

  /** Plot both motions, where two are chosen. */
  #compare() {
    for (const plot of this.#plots.splice(0)) plot.remove();
    this.facts.textContent = "";
    const [one, other] = this.#motions.map((read) => read?.motion);
    this.over.hidden = this.legend.hidden = !one || !other;
    if (!one || !other) return;
    const isShare = this.axis.value === "share";
    const found = isShare ? compareMotions(overShare(one), overShare(other)) : compareMotions(one, other);
    const unit = isShare ? "%" : "s";
    const at = formatNumber(found.largestAt, isShare ? 0 : 2, unit);
    this.facts.textContent = `Apart by ${formatLength(found.mean)} in the mean, at most by ${formatLength(found.largest)} at ${at}.`;
    const names = this.numbers.map(({ value }) => `demonstration ${value.trim()}`);
    const key = (/** @type {number} */ k) => element("span", { class: `swatch way-${k}` });
    this.legend.replaceChildren(...names.map((name, k) => element("span", {}, key(k), name)));
    const series = names.map((label, k) => ({ label, color: `--way-${k}` }));
    for (const [axis, letter] of ["x", "y", "z"].entries()) {
      const plot = this.#plot({ title: `${letter} [m]`, label: `${letter} of ${names.join(" and ")}`, series }, unit);
      plot.setData([found.times, ...found.places.map((places) => places.map((place) => place?.[axis] ?? null))]);
    }
    const distance = { title: "Distance between them [mm]", label: this.facts.textContent, height: DISTANCE_HEIGHT };
    const between = this.#plot({ ...distance, series: [{ label: "distance", color: "--departs" }] }, unit);
    between.setData([found.times, found.distances.map((metres) => metres && 1000 * metres)]);
  }

  /** @param {import("../line_plot.js").PlotOptions} options @param {string} xUnit */
  #plot(options, xUnit) {
    const plot = new LinePlot(this.comparison, { height: AXIS_HEIGHT, xUnit, ...options });
    this.#plots.push(plot);
    return plot;
  }

  /** Draw in the view what stays of the one, and the other beside it. */
  #draw() {
    const [one, other] = this.#isShown ? this.#motions : [null, null];
    const { grasp, release } = this.#shownMarks();
    const kept = one?.motion.positions.filter((_, k) => {
      const time = one.motion.times[k];
      return time >= grasp && time <= release;
    });
    this.context.overlay.setLine(LINES.one, kept?.length ? kept : null, { opacity: 1 });
    this.context.overlay.setLine(LINES.other, other?.motion.positions ?? null, { color: 0xd55e00, opacity: 1 });
  }
}
