// Round tubes along a way, thin or as wide as the demonstrations spread.
const SIDES = 10;

// A three.js geometry of a tube along `points` [[x, y, z]], of one radius or one a point. Each ring's frame is the one
// before, reflected twice, so that it is not twisted (Wang et al., ACM Transactions on Graphics 27(1), 2008).
export function tube(points, radius) {
  const { THREE } = globalThis.MeshCat;
  const at = points.map((point) => new THREE.Vector3(...point));
  const tangents = at.map((_, i) => at[Math.min(i + 1, at.length - 1)].clone().sub(at[Math.max(i - 1, 0)]).normalize());
  const normals = [across(THREE, tangents[0])];
  for (let i = 0; i + 1 < at.length; i++) {
    const step = at[i + 1].clone().sub(at[i]);
    const normal = mirrored(normals[i], step);
    const turn = tangents[i + 1].clone().sub(mirrored(tangents[i], step));
    normals.push(turn.lengthSq() > 1e-18 ? mirrored(normal, turn) : normal);
  }
  const positions = [];
  const directions = [];
  for (let i = 0; i < at.length; i++) {
    const beside = tangents[i].clone().cross(normals[i]);
    const size = Array.isArray(radius) ? radius[i] : radius;
    for (let k = 0; k < SIDES; k++) {
      const angle = (2 * Math.PI * k) / SIDES;
      const out = normals[i].clone().multiplyScalar(Math.cos(angle)).addScaledVector(beside, Math.sin(angle));
      directions.push(...out.toArray());
      positions.push(...out.multiplyScalar(size).add(at[i]).toArray());
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(directions, 3));
  geometry.setIndex(faces(at.length));
  return geometry;
}

function faces(rings) {
  const found = [];
  for (let i = 0; i + 1 < rings; i++) {
    for (let k = 0; k < SIDES; k++) {
      const [a, b] = [i * SIDES + k, i * SIDES + ((k + 1) % SIDES)];
      found.push(a, b, a + SIDES, b, b + SIDES, a + SIDES);
    }
  }
  return found;
}

function across(THREE, tangent) {
  const axis = Math.abs(tangent.z) < 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
  return tangent.clone().cross(axis).normalize();
}

function mirrored(vector, plane) {
  return vector.clone().addScaledVector(plane, (-2 * plane.dot(vector)) / (plane.lengthSq() || 1));
}
