"""Judges plans of an arm from a model by MuJoCo, which reads the model itself."""

from pathlib import Path

import mujoco
import numpy as np
from scipy.spatial import cKDTree

from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.sampled_plan import sample_plan
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Plan, Scene, Shape

RATE = 250.0  # [Hz]
POINTS = 100_001  # of the curve
NODE_STRIDE = 10  # setpoints from one whose clearance is measured to the next
ROUNDING = 1e-6  # [m]
KINDS = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}


class ModelJudge:
    """Judges plans of one arm.

    Args:
        file: of its model.
        height: on which the model stands [m].
        tool_length: from the model's frame `tool0` ahead to the tool centre point [m].
    """

    def __init__(self, file: Path, height: float, tool_length: float) -> None:
        self._file, self._base, self._tool_length = file, np.array([0.0, 0.0, height]), tool_length

    def accepts(self, made: Plan, curve: Curve, scene: Scene, arm: Arm) -> bool:
        """Tell whether the tool is on the path and points down, and the links keep away from the scene's shapes."""
        settings, model = MotionSettings(), self._model(scene)
        data, points = mujoco.MjData(model), cKDTree(curve(np.linspace(0.0, 1.0, POINTS)))
        for number, q in enumerate(sample_plan(made, RATE, arm).positions):
            data.qpos[:] = q
            mujoco.mj_kinematics(model, data)
            place, turn = self._tool(model, data)
            if points.query(place)[0] > settings.path_tolerance or turn[2, 2] > -1.0 + 1e-6:
                return False
            if number % NODE_STRIDE == 0 and self._clearance(model, data) < settings.clearance_min - ROUNDING:
                return False
        return True

    def _clearance(self, model: mujoco.MjModel, data: mujoco.MjData) -> float:
        """Return the least distance of the moving links to the scene's shapes [m], up to 1."""
        shapes = [geom for geom in range(model.ngeom) if model.geom(geom).name.startswith("shape ")]
        links = [
            geom for geom in range(model.ngeom) if geom not in shapes and model.geom_bodyid[geom] > self._fixed(model)
        ]
        pairs = [(link, shape) for link in links for shape in shapes]
        return min((mujoco.mj_geomDistance(model, data, *pair, 1.0, None) for pair in pairs), default=1.0)

    def _model(self, scene: Scene) -> mujoco.MjModel:
        return self._spec(scene).compile()

    def _spec(self, scene: Scene) -> mujoco.MjSpec:
        spec = mujoco.MjSpec.from_file(str(self._file))
        spec.compiler.fusestatic = False
        for number, shape in enumerate(scene.obstacles):
            place, size = np.array(shape.position) - self._base, _half_sizes(shape)
            spec.worldbody.add_geom(
                name=f"shape {number}", type=KINDS[shape.kind], size=size, pos=place, quat=shape.orientation
            )
        return spec

    def _fixed(self, model: mujoco.MjModel) -> int:
        """Return the last body that no joint moves."""
        return int(model.jnt_bodyid[0]) - 1

    def _tool(self, model: mujoco.MjModel, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray]:
        """Return the tool centre point [m, world] and the tool's orientation (3, 3)."""
        if model.nsite:
            place, turn = data.site("tool0").xpos, data.site("tool0").xmat.reshape(3, 3)
        else:
            place, turn = data.body("tool0").xpos, data.body("tool0").xmat.reshape(3, 3)
        return place + self._base + self._tool_length * turn[:, 2], turn


def _half_sizes(shape: Shape) -> list[float]:
    if shape.kind == "box":
        return [length / 2 for length in shape.size]
    return [shape.size[0], shape.size[1] / 2, 0.0] if shape.kind == "cylinder" else [shape.size[0], 0.0, 0.0]
