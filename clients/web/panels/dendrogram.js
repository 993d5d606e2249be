// The drawing of a dendrogram: leaves on the left, one below the other, merges to the right of them by their height.
import { element, svgElement } from "../elements.js";
import { wayClass } from "../way_colors.js";

const WIDTH = 356;
const LEFT = 30; // room for the numbers of the leaves
const RIGHT = 8;
const MIN_LABELLED_ROW = 11; // [px] rows below this have no numbers

export class Dendrogram {
  constructor() {
    this.element = element("div", { class: "tree" });
    this.onDrag = () => {};
  }

  // Draw a dendrogram up to the height `top` [m]; `numbers` are those of the demonstrations.
  draw({ demonstrations, leaves, merges }, top, numbers) {
    this.top = top;
    const row = Math.min(17, Math.max(3, 240 / leaves.length));
    const tall = row * leaves.length + 8;
    const places = new Map(leaves.map((id, i) => [id, 4 + (i + 0.5) * row]));
    const nodes = demonstrations.map((id) => ({
      x: LEFT,
      y: places.get(id),
      first: leaves.indexOf(id),
      last: leaves.indexOf(id),
    }));
    this.links = [];
    for (const [left, right, height] of merges) {
      const [a, b] = [nodes[left], nodes[right]];
      const x = this.#at(height);
      nodes.push({ x, y: (a.y + b.y) / 2, first: Math.min(a.first, b.first), last: Math.max(a.last, b.last) });
      this.links.push({
        height,
        first: Math.min(a.first, b.first),
        drawn: svgElement("path", { d: `M${a.x},${a.y}H${x}V${b.y}H${b.x}`, class: "link" }),
      });
    }
    this.leaves = leaves.map((id) => this.#leaf(id, places.get(id), row, numbers));
    this.line = svgElement("line", { class: "cut-line", y1: 0, y2: tall });
    this.handle = svgElement("line", { class: "cut-handle", y1: 0, y2: tall });
    this.handle.addEventListener("pointerdown", (event) => this.#drag(event));
    const title = `Dendrogram of ${leaves.length} demonstrations`;
    this.element.replaceChildren(
      svgElement(
        "svg",
        { viewBox: `0 0 ${WIDTH} ${tall}`, role: "group", "aria-label": title },
        this.links.map((link) => link.drawn),
        this.leaves.map((leaf) => leaf.drawn),
        this.line,
        this.handle,
      ),
    );
  }

  // Colour what a cut leaves together; what it parts is dashed.
  color(cut, height) {
    const x = this.#at(height);
    for (const line of [this.line, this.handle]) for (const end of ["x1", "x2"]) line.setAttribute(end, x);
    const way = (leaf) => (cut ? cut.leaf_ranges.findIndex(([begin, end]) => leaf >= begin && leaf < end) + 1 : 0);
    for (const link of this.links) {
      const parted = link.height > height;
      link.drawn.setAttribute("class", parted || !cut ? "link parted" : `link ${wayClass(way(link.first))}`);
    }
    for (const [i, leaf] of this.leaves.entries()) leaf.dot.setAttribute("class", `dot ${cut ? wayClass(way(i)) : ""}`);
  }

  #leaf(id, y, row, numbers) {
    const dot = svgElement("circle", { cx: LEFT - 4, cy: y, r: Math.min(3.5, row / 2), class: "dot" });
    const text =
      row >= MIN_LABELLED_ROW &&
      svgElement("text", { x: LEFT - 12, y: y + 4, "text-anchor": "end" }, String(numbers.get(id) ?? "?"));
    const ground = svgElement("rect", { x: 0, y: y - row / 2, width: LEFT + 6, height: row, class: "ground" });
    return { dot, drawn: svgElement("g", { "data-focus": `demonstrations ${id}`, class: "leaf" }, ground, dot, text) };
  }

  #at(height) {
    return LEFT + (height / this.top) * (WIDTH - LEFT - RIGHT);
  }

  #drag(event) {
    const svg = this.element.firstElementChild;
    const box = svg.getBoundingClientRect();
    const move = ({ clientX }) =>
      this.onDrag(((((clientX - box.left) / box.width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT)) * this.top);
    this.handle.setPointerCapture(event.pointerId);
    this.handle.addEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) {
      this.handle.addEventListener(name, () => this.handle.removeEventListener("pointermove", move), { once: true });
    }
    event.preventDefault();
  }
}
