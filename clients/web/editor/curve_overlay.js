// Draws the edited curve in the 3-D view: a tube, its control polygon and control points, and lines of what it began from.
// Everything is rewritten in place, so that a drag costs a fraction of a frame.
import { BasisFunctions, evaluateCurve, linspace } from "../nurbs.js";
import { arcLengths } from "../polyline.js";
import { TubeGeometry } from "../tube_geometry.js";
import { PointNumbers } from "./point_numbers.js";

const SAMPLES = 201;
const MAX_CONTROL_POINTS = 512; // control points
const PARAMETERS = linspace(SAMPLES);
const RADIUS = 0.0045; // [m]
const LINES = ["edit-original", "edit-first", "edit-second", "edit-adapted"]; // that the editor draws

export class CurveOverlay {
  /** @type {BasisFunctions | null} */
  #basis = null;
  #points = new Float64Array(3 * SAMPLES);
  /** @type {import("./draft.js").Draft | null} */
  #draft = null; // whose selection is drawn

  /** @param {import("../overlay.js").Overlay} overlay */
  constructor(overlay) {
    const { THREE } = overlay;
    this.overlay = overlay;
    this.group = new THREE.Group();
    this.tube = new TubeGeometry(SAMPLES);
    this.corridor = new TubeGeometry(SAMPLES);
    this.corridorMesh = new THREE.Mesh(this.corridor.geometry, tubeMaterial(0.13));
    this.positions = new Float32Array(3 * MAX_CONTROL_POINTS);
    const position = new THREE.BufferAttribute(this.positions, 3).setUsage(THREE.DynamicDrawUsage);
    this.colors = new THREE.BufferAttribute(new Float32Array(3 * MAX_CONTROL_POINTS), 3);
    const lineMaterial = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.7 });
    this.polygon = new THREE.Line(unculledGeometry({ position }), lineMaterial);
    this.handles = new THREE.Points(unculledGeometry({ position, color: this.colors }), dotMaterial(13));
    this.marker = new THREE.Points(new THREE.BufferGeometry().setFromPoints([new THREE.Vector3()]), ringMaterial(22));
    this.marker.visible = false;
    for (const [i, drawn] of [this.polygon, this.handles, this.marker].entries()) drawn.renderOrder = 2 + i;
    const tubeMesh = new THREE.Mesh(this.tube.geometry, tubeMaterial());
    this.group.add(this.corridorMesh, tubeMesh, this.polygon, this.handles, this.marker);
    this.numbers = new PointNumbers(this.group);
    this.group.visible = false;
    overlay.group.add(this.group);
    this.setColors(null);
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.#draft && this.setSelection(this.#draft));
  }

  /** @param {boolean} visible */
  show(visible) {
    this.group.visible = visible;
    if (!visible) for (const name of LINES) this.overlay.setLine(name, null);
    this.overlay.requestDraw();
  }

  /**
   * The curve itself: called in every frame of a drag.
   * @param {Curve} curve
   */
  setCurve(curve) {
    if (!this.#basis?.matches(curve)) this.#basis = new BasisFunctions(curve.degree, curve.knots, PARAMETERS);
    this.tube.setPath(this.#basis.evaluate(curve, this.#points), RADIUS);
    for (const [i, point] of curve.control_points.entries()) this.positions.set(point, 3 * i);
    this.numbers.move(curve.control_points);
    this.polygon.geometry.attributes.position.needsUpdate = true;
    for (const drawn of [this.polygon, this.handles]) drawn.geometry.setDrawRange(0, curve.control_points.length);
    this.overlay.requestDraw();
  }

  /**
   * Which control points are selected, and which are pinned.
   * @param {import("./draft.js").Draft} draft
   */
  setSelection(draft) {
    this.#draft = draft;
    this.numbers.choose(draft);
    const [ink, selected, pinned] = [themeColor("--ink"), themeColor("--way-1"), themeColor("--faint")];
    for (let i = 0; i <= draft.last; i++) {
      const { r, g, b } = draft.selected.includes(i) ? selected : draft.isPinned(i) ? pinned : ink;
      this.colors.setXYZ(i, r, g, b);
    }
    this.colors.needsUpdate = true;
    this.polygon.material.color.copy(pinned);
    this.overlay.requestDraw();
  }

  /**
   * @param {((u: number, out: number[]) => void) | null} color writes the colour of the curve at a parameter; null: not known
   * @param {Point | null} fault where the arm fails
   */
  setColors(color, fault = null) {
    const { r, g, b } = themeColor("--accent");
    this.tube.setColors((i, out) => {
      if (color) color(PARAMETERS[i], out);
      else out.splice(0, 3, r, g, b);
    });
    this.marker.visible = Boolean(fault);
    if (fault) this.marker.position.fromArray(fault);
    this.overlay.requestDraw();
  }

  /**
   * The curve that the draft began from, and around the learned one the corridor of the demonstrations.
   * @param {Curve} original
   * @param {Curve | null} learned
   * @param {number[] | null} spread radii [m]
   */
  setReference(original, learned, spread) {
    const style = { color: themeColor("--ink"), opacity: 0.7, dashed: true };
    this.overlay.setLine("edit-original", evaluateCurve(original, PARAMETERS), style);
    this.corridorMesh.visible = Boolean(learned && spread?.length);
    if (!learned || !spread?.length) return;
    const points = evaluateCurve(learned, PARAMETERS);
    const along = arcLengths(points);
    const total = along[along.length - 1];
    this.corridor.setPath(
      points.flat(),
      along.map((length) => interpolate(spread, (length / total) * (spread.length - 1))),
    );
    const { r, g, b } = themeColor("--accent");
    this.corridor.setColors((_, out) => out.splice(0, 3, r, g, b));
  }

  /**
   * Two versions side by side; null removes them.
   * @param {Curve | null} first
   * @param {Curve | null} second
   */
  setComparison(first, second) {
    this.overlay.setLine("edit-first", first && evaluateCurve(first, PARAMETERS), { color: 0xe69f00, opacity: 1 });
    this.overlay.setLine("edit-second", second && evaluateCurve(second, PARAMETERS), { color: 0xcc79a7, opacity: 1 });
  }
}

function tubeMaterial(opacity = 1) {
  const { THREE } = globalThis.MeshCat;
  return new THREE.MeshBasicMaterial({
    vertexColors: true,
    transparent: opacity < 1,
    opacity,
    depthWrite: opacity === 1,
    side: THREE.DoubleSide,
  });
}

/** @param {Record<string, THREE.BufferAttribute>} attributes */
function unculledGeometry(attributes) {
  const { THREE } = globalThis.MeshCat;
  const geometry = new THREE.BufferGeometry();
  for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
  geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e3); // never culled, never computed again
  return geometry;
}

/** @param {number} size [px] of a dot in the colour of its vertex */
const dotMaterial = (size) =>
  spriteMaterial(size, true, (pen) => {
    pen.arc(32, 32, 27, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: "#fff", lineWidth: 5, strokeStyle: "rgb(255 255 255 / 0.6)" });
    pen.fill();
    pen.stroke();
  });

/** @param {number} size [px] of a red ring */
const ringMaterial = (size) =>
  spriteMaterial(size, false, (pen) => {
    pen.arc(32, 32, 24, 0, 2 * Math.PI);
    Object.assign(pen, { lineWidth: 11, strokeStyle: "#c8281e" });
    pen.stroke();
  });

/**
 * A picture of a constant size on the screen, seen through everything.
 * @param {number} size
 * @param {boolean} vertexColors
 * @param {(pen: CanvasRenderingContext2D) => void} draw on 64 by 64 pixels
 */
function spriteMaterial(size, vertexColors, draw) {
  const { THREE } = globalThis.MeshCat;
  const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
  const pen = canvas.getContext("2d");
  if (pen) draw(pen);
  const screen = { size: size * devicePixelRatio, sizeAttenuation: false, depthTest: false };
  const map = new THREE.CanvasTexture(canvas);
  const material = new THREE.PointsMaterial({ ...screen, map, alphaTest: 0.3, transparent: true, vertexColors });
  material.fog = false;
  return material;
}

/** @param {string} variable of the style sheet */
function themeColor(variable) {
  const value = getComputedStyle(document.documentElement).getPropertyValue(variable);
  return new globalThis.MeshCat.THREE.Color(value.trim());
}

/** @param {number[]} values @param {number} at index, between two of them */
function interpolate(values, at) {
  const low = Math.min(values.length - 2, Math.floor(at));
  return values[low] + (at - low) * (values[low + 1] - values[low]);
}
