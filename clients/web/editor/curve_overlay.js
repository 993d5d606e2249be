// Draws the edited curve in the 3-D view: a tube, its control polygon and control points, and lines of what it began from.
// Everything is rewritten in place, so that a drag costs a fraction of a frame.
import { BasisFunctions, evaluateCurve, linspace } from "../nurbs.js";
import { arcLengths } from "../polyline.js";
import { TubeGeometry } from "../tube_geometry.js";

const SAMPLES = 201;
const MAX_CONTROL_POINTS = 512; // control points
const PARAMETERS = linspace(SAMPLES);
const RADIUS = 0.0045; // [m]

export class CurveOverlay {
  #basis = null;
  #points = new Float64Array(3 * SAMPLES);

  constructor(overlay) {
    const { THREE } = overlay;
    this.overlay = overlay;
    this.group = new THREE.Group();
    this.tube = new TubeGeometry(SAMPLES);
    this.corridor = new TubeGeometry(SAMPLES);
    this.corridorMesh = new THREE.Mesh(this.corridor.geometry, tubeMaterial(THREE, 0.13));
    this.positions = new Float32Array(3 * MAX_CONTROL_POINTS);
    const position = new THREE.BufferAttribute(this.positions, 3).setUsage(THREE.DynamicDrawUsage);
    this.colors = new THREE.BufferAttribute(new Float32Array(3 * MAX_CONTROL_POINTS), 3);
    this.polygon = new THREE.Line(
      unculledGeometry(THREE, { position }),
      new THREE.LineBasicMaterial({ transparent: true, opacity: 0.7 }),
    );
    this.handles = new THREE.Points(unculledGeometry(THREE, { position, color: this.colors }), dotMaterial(THREE, 13));
    this.marker = new THREE.Points(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3()]),
      dotMaterial(THREE, 22, true),
    );
    this.marker.visible = false;
    Object.assign(this.polygon, { renderOrder: 2 });
    Object.assign(this.handles, { renderOrder: 3 });
    this.marker.renderOrder = 4;
    this.group.add(
      this.corridorMesh,
      new THREE.Mesh(this.tube.geometry, tubeMaterial(THREE)),
      this.polygon,
      this.handles,
      this.marker,
    );
    this.group.visible = false;
    overlay.group.add(this.group);
    this.setColors(null);
    matchMedia("(prefers-color-scheme: dark)").addEventListener(
      "change",
      () => this.draft && this.setSelection(this.draft),
    );
  }

  show(visible) {
    this.group.visible = visible;
    if (!visible) for (const name of ["edit-original", "edit-first", "edit-second"]) this.overlay.setLine(name, null);
    this.overlay.requestDraw();
  }

  // The curve itself: called in every frame of a drag.
  setCurve({ curve }) {
    if (!this.#basis?.matches(curve)) this.#basis = new BasisFunctions(curve.degree, curve.knots, PARAMETERS);
    this.tube.setPath(this.#basis.evaluate(curve, this.#points), RADIUS);
    for (const [i, point] of curve.control_points.entries()) this.positions.set(point, 3 * i);
    this.polygon.geometry.attributes.position.needsUpdate = true;
    for (const drawn of [this.polygon, this.handles]) drawn.geometry.setDrawRange(0, curve.control_points.length);
    this.overlay.requestDraw();
  }

  // Which control points are selected, and which are pinned.
  setSelection(draft) {
    this.draft = draft;
    const color = {
      ink: themeColor(this.overlay, "--ink"),
      selected: themeColor(this.overlay, "--way-1"),
      pinned: themeColor(this.overlay, "--faint"),
    };
    draft.curve.control_points.forEach((_, i) => {
      const { r, g, b } = color[draft.selected.includes(i) ? "selected" : draft.isPinned(i) ? "pinned" : "ink"];
      this.colors.setXYZ(i, r, g, b);
    });
    this.colors.needsUpdate = true;
    this.polygon.material.color.copy(color.pinned);
    this.overlay.requestDraw();
  }

  // `color(u, out)` writes the colour of the curve at a parameter; null: not known. `fault`: where the arm fails [m], or null.
  setColors(color, fault) {
    const plain = themeColor(this.overlay, "--accent");
    this.tube.setColors(
      color ? (i, out) => color(PARAMETERS[i], out) : (_, out) => out.splice(0, 3, plain.r, plain.g, plain.b),
    );
    this.marker.visible = Boolean(fault);
    if (fault) this.marker.position.set(...fault);
    this.overlay.requestDraw();
  }

  // The curve that the draft began from, and around the learned one the corridor of the demonstrations' `spread` [m].
  setReference(original, learned, spread) {
    this.overlay.setLine("edit-original", evaluateCurve(original, PARAMETERS), {
      color: themeColor(this.overlay, "--ink"),
      opacity: 0.7,
      dashed: true,
    });
    this.corridorMesh.visible = Boolean(spread?.length);
    if (!spread?.length) return;
    const points = evaluateCurve(learned, PARAMETERS);
    const along = arcLengths(points);
    this.corridor.setPath(
      points.flat(),
      along.map((s) => interpolate(spread, (s / along.at(-1)) * (spread.length - 1))),
    );
    const { r, g, b } = themeColor(this.overlay, "--accent");
    this.corridor.setColors((_, out) => out.splice(0, 3, r, g, b));
  }

  // Two versions side by side; null removes them.
  setComparison(first, second) {
    this.overlay.setLine("edit-first", first && evaluateCurve(first, PARAMETERS), { color: 0xe69f00, opacity: 1 });
    this.overlay.setLine("edit-second", second && evaluateCurve(second, PARAMETERS), { color: 0xcc79a7, opacity: 1 });
  }
}

function tubeMaterial(THREE, opacity = 1) {
  return new THREE.MeshBasicMaterial({
    vertexColors: true,
    transparent: opacity < 1,
    opacity,
    depthWrite: opacity === 1,
    side: THREE.DoubleSide,
  });
}

function unculledGeometry(THREE, attributes) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
  geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e3); // never culled, never computed again
  return geometry;
}

// Round dots of a constant size on the screen, seen through everything.
function dotMaterial(THREE, size, ring = false) {
  const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
  const pen = canvas.getContext("2d");
  pen.arc(32, 32, ring ? 24 : 27, 0, 2 * Math.PI);
  if (ring) Object.assign(pen, { lineWidth: 11, strokeStyle: "#c8281e" }).stroke();
  else {
    Object.assign(pen, { fillStyle: "#fff" }).fill();
    Object.assign(pen, { lineWidth: 5, strokeStyle: "rgb(255 255 255 / 0.6)" }).stroke();
  }
  const style = {
    size: size * devicePixelRatio,
    sizeAttenuation: false,
    map: new THREE.CanvasTexture(canvas),
    alphaTest: 0.3,
    transparent: true,
    depthTest: false,
  };
  return new THREE.PointsMaterial({ ...style, vertexColors: !ring, fog: false });
}

function themeColor(overlay, variable) {
  return new overlay.THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(variable).trim());
}

function interpolate(values, at) {
  const low = Math.min(values.length - 2, Math.floor(at));
  return values[low] + (at - low) * (values[low + 1] - values[low]);
}
