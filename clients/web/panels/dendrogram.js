// The drawing of a dendrogram: leaves on the left, one below the other, merges to the right of them by their height.
import { element, svgElement } from "../elements.js";
import { wayClass } from "../way_colors.js";

const WIDTH = 356;
const LEFT_MARGIN = 30; // room for the numbers of the leaves
const RIGHT_MARGIN = 8;
const MIN_LABELLED_ROW = 11; // [px] rows below this have no numbers

/**
 * @typedef {{x: number, y: number, first: number}} MergeNode `first`: its uppermost leaf
 * @typedef {{height: number, first: number, drawn: SVGElement}} Link
 */

export class DendrogramView {
  element = element("div", { class: "tree" });
  /** @type {Link[]} */
  #links = [];
  /** @type {SVGElement[]} */
  #dots = [];
  #top = 1; // [m] height at the right

  /** @param {(height: number) => void} onDrag called while the cut is dragged */
  constructor(onDrag) {
    this.onDrag = onDrag;
    this.line = svgElement("line", { class: "cut-line", y1: 0 });
    this.handle = svgElement("line", { class: "cut-handle", y1: 0 });
    this.handle.addEventListener("pointerdown", (event) => this.#drag(event));
  }

  /**
   * @param {Dendrogram} dendrogram
   * @param {number} top height up to which it is drawn [m]
   * @param {Map<string, number>} numbers of the demonstrations
   */
  draw({ demonstrations, leaves, merges }, top, numbers) {
    this.#top = top;
    const row = Math.min(17, Math.max(3, 240 / leaves.length));
    const tall = row * leaves.length + 8;
    /** @param {number} leaf */
    const yOf = (leaf) => 4 + (leaf + 0.5) * row;
    const nodes = demonstrations.map((id) => ({
      x: LEFT_MARGIN,
      y: yOf(leaves.indexOf(id)),
      first: leaves.indexOf(id),
    }));
    this.#links = merges.map(([left, right, height]) => this.#link(nodes, left, right, height));
    this.#dots = leaves.map((_, i) => dot(yOf(i), row));
    const drawn = leaves.map((id, i) => leaf(id, yOf(i), row, this.#dots[i], numbers.get(id)));
    for (const line of [this.line, this.handle]) line.setAttribute("y2", String(tall));
    const title = `Dendrogram of ${leaves.length} demonstrations`;
    const view = { viewBox: `0 0 ${WIDTH} ${tall}`, role: "group", "aria-label": title };
    const links = this.#links.map((link) => link.drawn);
    this.element.replaceChildren(svgElement("svg", view, links, drawn, this.line, this.handle));
  }

  /**
   * Colour what a cut leaves together; what it parts is dashed.
   * @param {Cut | null} cut
   * @param {number} height [m]
   */
  color(cut, height) {
    const x = String(this.#xOf(height));
    for (const line of [this.line, this.handle]) for (const end of ["x1", "x2"]) line.setAttribute(end, x);
    /** @param {number} leaf */
    const way = (leaf) => (cut?.leaf_ranges.findIndex(([begin, end]) => leaf >= begin && leaf < end) ?? -1) + 1;
    for (const link of this.#links) {
      const parted = link.height > height || !cut;
      link.drawn.setAttribute("class", parted ? "link parted" : `link ${wayClass(way(link.first))}`);
    }
    for (const [i, one] of this.#dots.entries()) one.setAttribute("class", `dot ${cut ? wayClass(way(i)) : ""}`);
  }

  /**
   * The link of a merge, which makes a further node.
   * @param {MergeNode[]} nodes
   * @param {number} left
   * @param {number} right
   * @param {number} height [m]
   */
  #link(nodes, left, right, height) {
    const [a, b] = [nodes[left], nodes[right]];
    const [x, first] = [this.#xOf(height), Math.min(a.first, b.first)];
    nodes.push({ x, y: (a.y + b.y) / 2, first });
    return { height, first, drawn: svgElement("path", { d: `M${a.x},${a.y}H${x}V${b.y}H${b.x}`, class: "link" }) };
  }

  /** @param {number} height */
  #xOf(height) {
    return LEFT_MARGIN + (height / this.#top) * (WIDTH - LEFT_MARGIN - RIGHT_MARGIN);
  }

  /** @param {PointerEvent} event */
  #drag(event) {
    const box = (this.element.firstElementChild ?? this.element).getBoundingClientRect();
    const dragging = new AbortController();
    const { signal } = dragging;
    /** @param {PointerEvent} event */
    const move = ({ clientX }) => {
      const x = ((clientX - box.left) / box.width) * WIDTH;
      this.onDrag(((x - LEFT_MARGIN) / (WIDTH - LEFT_MARGIN - RIGHT_MARGIN)) * this.#top);
    };
    this.handle.setPointerCapture(event.pointerId);
    this.handle.addEventListener("pointermove", move, { signal });
    this.handle.addEventListener("pointerup", () => dragging.abort(), { signal });
    this.handle.addEventListener("pointercancel", () => dragging.abort(), { signal });
    event.preventDefault();
  }
}

/** @param {number} y @param {number} row */
const dot = (y, row) => svgElement("circle", { cx: LEFT_MARGIN - 4, cy: y, r: Math.min(3.5, row / 2), class: "dot" });

/**
 * @param {string} id
 * @param {number} y
 * @param {number} row height
 * @param {SVGElement} dot
 * @param {number | undefined} number of the demonstration
 */
function leaf(id, y, row, dot, number) {
  const place = { x: LEFT_MARGIN - 12, y: y + 4, "text-anchor": "end" };
  const text = row >= MIN_LABELLED_ROW && svgElement("text", place, String(number ?? "?"));
  const ground = svgElement("rect", { x: 0, y: y - row / 2, width: LEFT_MARGIN + 6, height: row, class: "ground" });
  return svgElement("g", { "data-focus": `demonstrations ${id}`, class: "leaf" }, ground, dot, text);
}
