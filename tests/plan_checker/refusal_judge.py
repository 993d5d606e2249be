"""Judges refusals of paths for an arm from a model: by dense numeric inverse kinematics in MuJoCo, from many seeds.

At places along the path and for every roll of the tool that plans try, all configurations are looked for that keep the
joints' limits, stay away from singular poses and from the scene's shapes. A refusal is right where each roll has a
place without any, or where no sequence of neighbouring configurations goes through all places.
"""

from enum import StrEnum
from pathlib import Path

import mujoco
import numpy as np

from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Scene
from tests.plan_checker.model_judge import ModelJudge

PLACES = 16  # along the path
SEEDS = 150  # at each of them
ITERATIONS = 60
POSE_TOLERANCE = 1e-6  # [m and rad] between the tool and its pose
DAMPING = 1e-4
LARGEST_STEP = 0.3  # [rad] of an iteration
# Palm and closed fingers: centre, and half of the edges, in the frame that the gripper sits on [m].
GRIPPER = (
    ((0.0, 0.0, 0.0175), (0.022, 0.055, 0.0175)),
    ((0.0, 0.026, 0.085), (0.011, 0.006, 0.05)),
    ((0.0, -0.026, 0.085), (0.011, 0.006, 0.05)),
)
LINK = 0.8  # [rad] between configurations at two places beside each other


class Refusal(StrEnum):
    """What the search says of a refusal."""

    NO_CONFIGURATION = "every roll has a place without a configuration"
    NO_SEQUENCE = "configurations everywhere, and no sequence of neighbours"
    DOUBTFUL = "there is a sequence of configurations"


class RefusalJudge(ModelJudge):
    """Judges refusals of one arm; its links and the closed gripper are kept away from the shapes.

    Args:
        file: of its model.
        height: on which the model stands [m].
        tool_length: from the model's frame `tool0` ahead to the tool centre point [m].
    """

    def __init__(self, file: Path, height: float, tool_length: float) -> None:
        super().__init__(file, height, tool_length)
        self._random = np.random.default_rng(0)

    def _spec(self, scene: Scene) -> mujoco.MjSpec:
        spec = super()._spec(scene)
        site = spec.site("tool0")
        body = site.parent if site else spec.body("tool0")
        place, turn = (site.pos, site.quat) if site else (np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, turn)
        for center, half in GRIPPER:
            at = place + matrix.reshape(3, 3) @ center
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half, pos=at, quat=turn, mass=0.0)
        return spec

    def refuses(self, curve: Curve, scene: Scene) -> Refusal:
        """Tell what the search says of a path that a plan refuses."""
        model, settings = self._model(scene), MotionSettings()
        data = mujoco.MjData(model)
        places = curve(np.linspace(0.0, 1.0, PLACES))
        found = Refusal.NO_CONFIGURATION
        for roll in settings.rolls:
            near: np.ndarray | None = None
            for place in places:
                here = self._configurations(model, data, place, roll, settings)
                if not len(here):
                    break
                reached = np.ones(len(here), bool) if near is None else _neighbours(near, here)
                near = here[reached]
                if not len(near):
                    found = Refusal.NO_SEQUENCE
                    break
            else:
                return Refusal.DOUBTFUL
        return found

    def _configurations(
        self, model: mujoco.MjModel, data: mujoco.MjData, place: np.ndarray, roll: float, settings: MotionSettings
    ) -> np.ndarray:
        """Return configurations (n, joints) with the tool at a place (3,) [m, world], pointing down with a roll."""
        lower, upper = model.jnt_range.T
        c, s = np.cos(roll), np.sin(roll)
        down = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
        kept = []
        for q in self._random.uniform(lower, upper, (SEEDS, model.nq)):
            for _ in range(ITERATIONS):
                error, jacobian = self._error(model, data, q, place, down)
                if np.abs(error).max() < POSE_TOLERANCE:
                    break
                step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + DAMPING * np.eye(6), error)
                q = q + step * min(1.0, LARGEST_STEP / max(float(np.abs(step).max()), 1e-12))
            turned = q + 2 * np.pi * np.round(((lower + upper) / 2 - q) / (2 * np.pi))
            error, jacobian = self._error(model, data, turned, place, down)
            inside = np.all((turned >= lower) & (turned <= upper)) and np.abs(error).max() < 10 * POSE_TOLERANCE
            regular = np.linalg.svd(jacobian, compute_uv=False)[-1] >= settings.least_singular
            if inside and regular and self._clearance(model, data) >= settings.clearance_min:
                kept.append(turned)
        return np.array(kept).reshape(-1, model.nq)

    def _error(
        self, model: mujoco.MjModel, data: mujoco.MjData, q: np.ndarray, place: np.ndarray, down: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return what is lacking to the pose (6,) [m and rad], and the tool's Jacobian (6, joints)."""
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        at, turn = self._tool(model, data)
        lacking, turned = down @ turn.T, np.empty(3)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(lacking).ravel())
        mujoco.mju_quat2Vel(turned, quaternion, 1.0)
        jacobian = np.zeros((6, model.nv))
        body = model.site("tool0").bodyid[0] if model.nsite else model.body("tool0").id
        mujoco.mj_jac(model, data, jacobian[:3], jacobian[3:], at - self._base, int(body))
        return np.concatenate([place - at, turned]), jacobian


def _neighbours(before: np.ndarray, here: np.ndarray) -> np.ndarray:
    """Tell which of configurations (m, joints) have a neighbour among those (n, joints) at the place before."""
    return np.asarray((np.abs(here[:, None] - before).max(axis=2) <= LINK).any(axis=1))
