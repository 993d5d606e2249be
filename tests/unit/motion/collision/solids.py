"""Points on the surface of everything that moves, found from the MuJoCo model without the collision model."""

import mujoco
import numpy as np

from teachpath.motion.arm.geometry import collision_solids
from teachpath.motion.arm.mjcf import write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene

ARM = Arm.of_variant()

RIM = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


class Surface:
    """Corners of boxes and meshes, rims of cylinders, poles of spheres: of the arm's moving parts."""

    def __init__(self, arm: Arm = ARM) -> None:
        self._model = mujoco.MjModel.from_xml_string(write_mjcf(empty_scene(), arm))
        self._data = mujoco.MjData(self._model)
        self._geoms = [self._model.geom(part.name).id for part in collision_solids(arm) if part.link >= 1]
        self._local = [self._points(geom) for geom in self._geoms]

    def __call__(self, q: np.ndarray) -> np.ndarray:
        """Return the points (n, m, 3) [m] at configurations (n, 6)."""
        found = []
        for row in q:
            self._data.qpos[:6] = row
            mujoco.mj_kinematics(self._model, self._data)
            found.append(
                np.concatenate(
                    [
                        local @ self._data.geom_xmat[geom].reshape(3, 3).T + self._data.geom_xpos[geom]
                        for geom, local in zip(self._geoms, self._local, strict=True)
                    ]
                )
            )
        return np.array(found)

    def _points(self, geom: int) -> np.ndarray:
        kind, size = self._model.geom_type[geom], self._model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = self._model.geom_dataid[geom]
            first, count = self._model.mesh_vertadr[mesh], self._model.mesh_vertnum[mesh]
            return self._model.mesh_vert[first : first + count].astype(float)
        if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            ring = np.column_stack([size[0] * np.cos(RIM), size[0] * np.sin(RIM), np.full(len(RIM), size[1])])
            return np.concatenate([ring, ring * [1, 1, -1]])
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            return size[0] * np.concatenate([np.eye(3), -np.eye(3)])
        return SIGNS * size
