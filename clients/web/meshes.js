// Builds the 3-D view's shapes, demonstrations and paths as objects of three.js, in robot coordinates [m].
import { distance, resamplePolyline, sampleCurve, slicePolyline } from "./polyline.js";
import { TubeGeometry } from "./tube_geometry.js";
import { wayColor } from "./way_colors.js";

const GREY = 0x7a8694;
const RED = 0xd62718;

function phongMaterial(color, opacity = 1) {
  const { THREE } = globalThis.MeshCat;
  return new THREE.MeshPhongMaterial({
    color,
    opacity,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    shininess: 28,
    specular: 0x2a2a2a,
  });
}

const GEOMETRIES = {
  box: (THREE, { size }) => new THREE.BoxGeometry(...size),
  cylinder: (THREE, { size }) => new THREE.CylinderGeometry(size[0], size[0], size[1], 48).rotateX(Math.PI / 2),
  sphere: (THREE, { size }) => new THREE.SphereGeometry(size[0], 32, 24),
  mesh: (THREE, { size, vertices }) => {
    const geometry = new THREE.BufferGeometry().setFromPoints(
      vertices.map((p) => new THREE.Vector3(...p).multiplyScalar(size[0])),
    );
    geometry.computeVertexNormals(); // three corners a face, none shared: sharp edges
    return geometry;
  },
};

// A geometry of the scene's shape, about its own origin.
export const shapeGeometry = (shape) => GEOMETRIES[shape.kind](globalThis.MeshCat.THREE, shape);

export function shapeMesh(shape) {
  const { THREE } = globalThis.MeshCat;
  const mesh = new THREE.Mesh(shapeGeometry(shape), phongMaterial(shape.color));
  mesh.position.set(...shape.position);
  const [w, x, y, z] = shape.orientation;
  mesh.quaternion.set(x, y, z, w);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

export function demonstrationLine(points, cluster) {
  const { THREE } = globalThis.MeshCat;
  const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
  return new THREE.Line(
    geometry,
    new THREE.LineBasicMaterial({
      color: cluster ? wayColor(cluster) : GREY,
      opacity: cluster ? 0.75 : 1,
      transparent: Boolean(cluster),
    }),
  );
}

// Neighbours that coincide have no direction.
const withoutDuplicates = (points) => points.filter((point, i) => !i || distance(point, points[i - 1]) > 1e-5);

function tubeMesh(points, radius, material) {
  const { THREE } = globalThis.MeshCat;
  const tube = new TubeGeometry(points.length);
  tube.setPath(points.flat(), radius);
  const mesh = new THREE.Mesh(tube.geometry, material);
  mesh.castShadow = material.opacity === 1;
  return mesh;
}

// Drawn over everything: what is pointed at must not be hidden by an obstacle.
function drawOnTop(mesh) {
  mesh.material.depthTest = false;
  mesh.material.transparent = true; // drawn after all that is opaque
  mesh.renderOrder = mesh.material.color.getHex() === RED ? 2 : 1;
  mesh.castShadow = false;
  return mesh;
}

export const pathTube = (path) => tubeMesh(sampleCurve(path.curve), 0.005, phongMaterial(wayColor(path.cluster)));
export const deviationTube = (trajectory, share) =>
  drawOnTop(tubeMesh(slicePolyline(withoutDuplicates(trajectory), share), 0.0032, phongMaterial(RED)));
export const highlightTube = (trajectory, cluster) =>
  drawOnTop(tubeMesh(withoutDuplicates(trajectory), 0.0025, phongMaterial(cluster ? wayColor(cluster) : GREY)));

export function spreadTube(path, spread) {
  const around = tubeMesh(
    resamplePolyline(sampleCurve(path.curve), spread.length),
    spread.map((radius) => Math.max(radius, 0.0005)),
    phongMaterial(wayColor(path.cluster), 0.22),
  );
  around.material.side = globalThis.MeshCat.THREE.DoubleSide;
  return around;
}
