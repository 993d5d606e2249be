// What the editor draws in the 3-D view: the curve as a tube, its control polygon, its control points, and ghosts of
// what it began from. Everything is rewritten in place, so that a drag costs a fraction of a frame.
import { Basis, evaluate, evenly } from "../nurbs.js";
import { lengths } from "../polyline.js";
import { Tube } from "./tube_mesh.js";

const SAMPLES = 201;
const MOST = 512; // control points
const U = evenly(SAMPLES);
const RADIUS = 0.0045; // [m]

export class Sketch {
  #basis = null;
  #points = new Float64Array(3 * SAMPLES);

  constructor(easel) {
    const { THREE } = easel;
    this.easel = easel;
    this.group = new THREE.Group();
    this.tube = new Tube(THREE, SAMPLES, { radius: RADIUS });
    this.corridor = new Tube(THREE, SAMPLES, { radius: 0, opacity: 0.13 });
    this.positions = new Float32Array(3 * MOST);
    const position = new THREE.BufferAttribute(this.positions, 3).setUsage(THREE.DynamicDrawUsage);
    this.colours = new THREE.BufferAttribute(new Float32Array(3 * MOST), 3);
    this.polygon = new THREE.Line(endless(THREE, { position }), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.7 }));
    this.handles = new THREE.Points(endless(THREE, { position, color: this.colours }), dots(THREE, 13));
    this.marker = new THREE.Points(new THREE.BufferGeometry().setFromPoints([new THREE.Vector3()]), dots(THREE, 22, true));
    this.marker.visible = false;
    Object.assign(this.polygon, { renderOrder: 2 });
    Object.assign(this.handles, { renderOrder: 3 });
    this.marker.renderOrder = 4;
    this.group.add(this.corridor.mesh, this.tube.mesh, this.polygon, this.handles, this.marker);
    this.group.visible = false;
    easel.group.add(this.group);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draft && this.choice(this.draft));
  }

  show(visible) {
    this.group.visible = visible;
    if (!visible) for (const name of ["edit-original", "edit-first", "edit-second"]) this.easel.ghost(name, null);
    this.easel.dirty();
  }

  // The curve itself: called in every frame of a drag.
  redraw({ curve }) {
    if (!this.#basis?.fits(curve)) this.#basis = new Basis(curve.degree, curve.knots, U);
    this.tube.shape(this.#basis.points(curve, this.#points));
    curve.control_points.forEach((point, i) => this.positions.set(point, 3 * i));
    this.polygon.geometry.attributes.position.needsUpdate = true;
    for (const drawn of [this.polygon, this.handles]) drawn.geometry.setDrawRange(0, curve.control_points.length);
    this.easel.dirty();
  }

  // Which control points are chosen, and which are pinned.
  choice(draft) {
    this.draft = draft;
    const colour = { ink: themed(this.easel, "--ink"), chosen: themed(this.easel, "--way-1"), pinned: themed(this.easel, "--faint") };
    draft.curve.control_points.forEach((_, i) => {
      const { r, g, b } = colour[draft.chosen.includes(i) ? "chosen" : draft.isPinned(i) ? "pinned" : "ink"];
      this.colours.setXYZ(i, r, g, b);
    });
    this.colours.needsUpdate = true;
    this.polygon.material.color.copy(colour.pinned);
    this.easel.dirty();
  }

  // `colour(u, out)` writes the colour of the curve at a parameter; nothing: not known.
  paint(colour, fault) {
    const plain = themed(this.easel, "--accent");
    this.tube.paint(colour ? (i, out) => colour(U[i], out) : (_, out) => out.splice(0, 3, plain.r, plain.g, plain.b));
    this.marker.visible = Boolean(fault);
    if (fault) this.marker.position.set(...fault);
    this.easel.dirty();
  }

  // What was edited stays visible, with the corridor of the demonstrations around what was learned.
  ghosts(original, learned, spread) {
    this.easel.ghost("edit-original", evaluate(original, U), { color: themed(this.easel, "--ink"), opacity: 0.7, dashed: true });
    this.corridor.mesh.visible = Boolean(spread?.length);
    if (!spread?.length) return;
    const points = evaluate(learned, U);
    const along = lengths(points);
    this.corridor.shape(points.flat(), along.map((s) => between(spread, (s / along.at(-1)) * (spread.length - 1))));
    const { r, g, b } = themed(this.easel, "--accent");
    this.corridor.paint((_, out) => out.splice(0, 3, r, g, b));
  }

  // Two versions side by side; nothing takes them away.
  compare(first, second) {
    this.easel.ghost("edit-first", first && evaluate(first, U), { color: 0xe69f00, opacity: 1 });
    this.easel.ghost("edit-second", second && evaluate(second, U), { color: 0xcc79a7, opacity: 1 });
  }
}

function endless(THREE, attributes) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
  geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e3); // never culled, never computed again
  return geometry;
}

// Round dots of a constant size on the screen, seen through everything.
function dots(THREE, size, ring = false) {
  const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
  const pen = canvas.getContext("2d");
  pen.arc(32, 32, ring ? 24 : 27, 0, 2 * Math.PI);
  if (ring) Object.assign(pen, { lineWidth: 11, strokeStyle: "#c8281e" }).stroke();
  else {
    Object.assign(pen, { fillStyle: "#fff" }).fill();
    Object.assign(pen, { lineWidth: 5, strokeStyle: "rgb(255 255 255 / 0.6)" }).stroke();
  }
  const look = { size: size * devicePixelRatio, sizeAttenuation: false, map: new THREE.CanvasTexture(canvas), alphaTest: 0.3, transparent: true, depthTest: false };
  return new THREE.PointsMaterial({ ...look, vertexColors: !ring, fog: false });
}

function themed(easel, variable) {
  return new easel.THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(variable).trim());
}

function between(values, at) {
  const low = Math.min(values.length - 2, Math.floor(at));
  return values[low] + (at - low) * (values[low + 1] - values[low]);
}
