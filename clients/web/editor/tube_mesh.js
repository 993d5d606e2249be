// A tube around a polyline, each of its points with a colour and a radius; rewritten in place, frame by frame.
const SIDES = 7;

export class Tube {
  constructor(THREE, count, { radius, opacity = 1 }) {
    this.count = count;
    this.radius = radius;
    this.positions = new Float32Array(3 * count * SIDES);
    this.colours = new Float32Array(3 * count * SIDES).fill(1);
    const geometry = new THREE.BufferGeometry();
    for (const [name, array] of [["position", this.positions], ["color", this.colours]]) {
      geometry.setAttribute(name, new THREE.BufferAttribute(array, 3).setUsage(THREE.DynamicDrawUsage));
    }
    geometry.setIndex(triangles(count));
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e3); // never culled, never computed again
    const material = new THREE.MeshBasicMaterial({ vertexColors: true, transparent: opacity < 1, opacity, depthWrite: opacity === 1, side: THREE.DoubleSide });
    this.mesh = new THREE.Mesh(geometry, material);
  }

  // `points`: x, y, z after x, y, z [m]; `radii`: one a point, or nothing.
  shape(points, radii) {
    const side = new Float64Array(3);
    const tangent = new Float64Array(3);
    for (let i = 0; i < this.count; i++) {
      const [before, after] = [3 * Math.max(0, i - 1), 3 * Math.min(this.count - 1, i + 1)];
      for (let k = 0; k < 3; k++) tangent[k] = points[after + k] - points[before + k];
      if (!normalize(tangent)) continue; // two points in one place: the ring before stays
      turn(side, tangent);
      const radius = radii ? radii[i] : this.radius;
      for (let j = 0; j < SIDES; j++) this.#vertex(i, j, points, side, tangent, radius);
    }
    this.mesh.geometry.attributes.position.needsUpdate = true;
  }

  // `colour(i, out)` writes red, green, blue (0 to 1) of point i into out.
  paint(colour) {
    const out = [1, 1, 1];
    for (let i = 0; i < this.count; i++) {
      colour(i, out);
      for (let j = 0; j < SIDES; j++) this.colours.set(out, 3 * (i * SIDES + j));
    }
    this.mesh.geometry.attributes.color.needsUpdate = true;
  }

  #vertex(i, j, points, side, tangent, radius) {
    const angle = (2 * Math.PI * j) / SIDES;
    const [c, s] = [radius * Math.cos(angle), radius * Math.sin(angle)];
    const at = 3 * (i * SIDES + j);
    for (let k = 0; k < 3; k++) {
      const [a, b] = [(k + 1) % 3, (k + 2) % 3];
      this.positions[at + k] = points[3 * i + k] + c * side[k] + s * (tangent[a] * side[b] - tangent[b] * side[a]);
    }
  }
}

function triangles(count) {
  const index = [];
  for (let i = 0; i < count - 1; i++) {
    for (let j = 0; j < SIDES; j++) {
      const [a, b] = [i * SIDES + j, i * SIDES + ((j + 1) % SIDES)];
      index.push(a, a + SIDES, b, b, a + SIDES, b + SIDES);
    }
  }
  return index;
}

function normalize(v) {
  const length = Math.hypot(v[0], v[1], v[2]);
  if (length < 1e-12) return false;
  for (let k = 0; k < 3; k++) v[k] /= length;
  return true;
}

// Carry `side` along: what is left of it across the tangent, or any direction across when nothing is.
function turn(side, tangent) {
  const along = side[0] * tangent[0] + side[1] * tangent[1] + side[2] * tangent[2];
  for (let k = 0; k < 3; k++) side[k] -= along * tangent[k];
  if (normalize(side)) return;
  side.fill(0);
  const least = [0, 1, 2].reduce((best, k) => (Math.abs(tangent[k]) < Math.abs(tangent[best]) ? k : best), 0);
  side[least] = 1;
  turn(side, tangent);
}
