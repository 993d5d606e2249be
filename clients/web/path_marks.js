// What marks a path in the view: a ball at its start, a flag at its goal, cones that point ahead, and its number.
import { phongMaterial } from "./meshes.js";
import { arcLengths, resamplePolyline, sampleCurve } from "./polyline.js";
import { wayColor } from "./way_colors.js";

const SPACING = 0.14; // [m] between two cones
const [BALL, CONE, CONE_LENGTH] = [0.011, 0.011, 0.03]; // [m]
const [POLE, FLAG] = [0.075, 0.03]; // [m] heights
const LABEL = { pixels: 64, size: 0.017, above: 0.035 }; // size: share of the picture's height; above the path [m]

/**
 * Start, goal and direction, as one mesh.
 * @param {LearnedPath} path
 */
export function pathMarks(path) {
  const { THREE } = globalThis.MeshCat;
  const points = sampleCurve(path.curve);
  const cones = Math.max(2, Math.round((arcLengths(points).at(-1) ?? 0) / SPACING));
  const places = resamplePolyline(points, 2 * cones + 1).map((point) => new THREE.Vector3().fromArray(point));
  const [start, goal] = [places[0], places[places.length - 1]];
  const parts = [new THREE.SphereGeometry(BALL, 14, 10).translate(start.x, start.y, start.z), ...flag(goal)];
  for (let k = 1; k < places.length; k += 2) parts.push(cone(places[k], places[k + 1].clone().sub(places[k - 1])));
  return new THREE.Mesh(merged(parts), phongMaterial(wayColor(path.cluster)));
}

/**
 * The number of its way, above the middle of the path, as large wherever the camera is.
 * @param {LearnedPath} path
 */
export function pathName(path) {
  const { THREE } = globalThis.MeshCat;
  const canvas = Object.assign(document.createElement("canvas"), { width: LABEL.pixels, height: LABEL.pixels });
  const pen = canvas.getContext("2d");
  if (pen) writeNumber(pen, path.cluster);
  const map = new THREE.CanvasTexture(canvas);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, depthTest: false, sizeAttenuation: false }));
  const [x, y, z] = resamplePolyline(sampleCurve(path.curve), 3)[1];
  sprite.position.set(x, y, z + LABEL.above);
  sprite.scale.setScalar(LABEL.size);
  sprite.renderOrder = 3;
  return sprite;
}

/** @param {CanvasRenderingContext2D} pen @param {number} cluster */
function writeNumber(pen, cluster) {
  const middle = LABEL.pixels / 2;
  pen.fillStyle = `#${wayColor(cluster).toString(16).padStart(6, "0")}`;
  pen.arc(middle, middle, middle - 2, 0, 2 * Math.PI);
  pen.fill();
  Object.assign(pen, { fillStyle: "#fff", font: "bold 40px sans-serif", textAlign: "center", textBaseline: "middle" });
  Object.assign(pen, { strokeStyle: "rgb(0 0 0 / 0.55)", lineWidth: 5, lineJoin: "round" });
  pen.strokeText(String(cluster), middle, middle + 2);
  pen.fillText(String(cluster), middle, middle + 2);
}

/** @param {THREE.Vector3} at @returns {THREE.BufferGeometry[]} */
function flag({ x, y, z }) {
  const { THREE } = globalThis.MeshCat;
  const pole = new THREE.CylinderGeometry(0.002, 0.002, POLE, 6).rotateX(Math.PI / 2).translate(x, y, z + POLE / 2);
  // A three-sided cylinder on its side, which is seen from everywhere but above.
  const cloth = new THREE.ConeGeometry(FLAG / 2, 1.3 * FLAG, 3).rotateZ(-Math.PI / 2);
  return [pole, cloth.translate(x + 0.65 * FLAG, y, z + POLE - FLAG / 2)];
}

/** @param {THREE.Vector3} at @param {THREE.Vector3} ahead @returns {THREE.BufferGeometry} */
function cone(at, ahead) {
  const { THREE } = globalThis.MeshCat;
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), ahead.normalize());
  const geometry = new THREE.ConeGeometry(CONE, CONE_LENGTH, 10);
  return geometry.applyMatrix4(new THREE.Matrix4().compose(at, turn, new THREE.Vector3(1, 1, 1)));
}

/** One geometry of several: the view draws and dims it as one. @param {THREE.BufferGeometry[]} parts */
function merged(parts) {
  const { THREE } = globalThis.MeshCat;
  const flat = parts.map((part) => part.toNonIndexed());
  const geometry = new THREE.BufferGeometry();
  for (const name of ["position", "normal"]) {
    const values = flat.flatMap((part) => Array.from(part.attributes[name].array));
    geometry.setAttribute(name, new THREE.Float32BufferAttribute(values, 3));
  }
  for (const part of [...parts, ...flat]) part.dispose();
  return geometry;
}
