"""Motions to rest on which the tool turns only as it is told to: the wrist makes up for the joints before it.

Ruckig leads these and the rotation vector of the tool; the wrist, the last three joints, follows from both. So the tool
keeps its orientation on the whole way, and not at its ends alone, where no turn is asked for. What is sent is the
motion nearest to that whose jerk is constant in every control period (`constant_jerk.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from ruckig import InputParameter, Result, Ruckig, RuckigError, Trajectory
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.hand_kinematics import WRIST, HandKinematics
from teachpath.motion.timing.constant_jerk import MIN_PERIODS, ConstantJerkMotion

DIFFERENCE_STEP: Final = 1e-4  # [s] of the differences that give velocity and acceleration of the wrist
ZERO_VELOCITY: Final = np.zeros(3)


@dataclass(frozen=True, eq=False)
class ToolState:
    """Where the joints and the tool's orientation are at one instant, and how they move.

    Attributes:
        joints: (3, joints) position [rad], velocity and acceleration of the joints, one a row.
        orientation: (3, 3) to world from the tool.
        turning: (2, 3) angular velocity [rad/s] and acceleration of the tool, in axes of the world.
    """

    joints: Array
    orientation: Array
    turning: Array

    @classmethod
    def resting(cls, q: Array, orientation: Array) -> ToolState:
        """Return the state of an arm that rests at a configuration (joints,)."""
        return cls(np.array([q, *np.zeros((2, len(q)))]), orientation, np.zeros((2, 3)))


@dataclass(frozen=True, eq=False)
class ToolMotion:
    """A motion to rest, in samples one control period apart; the first is one period after its beginning.

    Attributes:
        joints: what they do.
    """

    joints: ConstantJerkMotion
    _turns: Array  # (n, 3, 3) rotation vector of the tool from `_reference`, its rate and second derivative
    _reference: Array  # (3, 3)

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def states(self) -> Array:
        """Position [rad], velocity and acceleration (n, 3, joints) at the samples."""
        return self.joints.states[1:]

    @property
    def positions(self) -> Array:
        """Configurations (n, joints) at the samples [rad]."""
        return self.states[:, 0]

    def tool_state(self, sample: int) -> ToolState:
        """Return the state at a sample, counted from 0; beyond the last one the arm rests."""
        if sample >= len(self) - 1:
            return ToolState.resting(self.positions[-1], self.final_orientation)
        before, now, after = _orientations(self._turns[sample : sample + 1], self._reference)[0]
        ahead, behind = (Rotation.from_matrix(m).as_rotvec() for m in (after @ now.T, now @ before.T))
        turning = np.array([(ahead + behind) / 2, (ahead - behind) / DIFFERENCE_STEP]) / DIFFERENCE_STEP
        return ToolState(self.states[sample], now, turning)

    @property
    def leading_speeds(self) -> Array:
        """Largest speeds (joints,) of the joints before the wrist and of the tool's turn [rad/s]."""
        rates = np.hstack([self.states[:, 1, :-WRIST], self._turns[:, 1]])
        return np.asarray(np.abs(rates).max(axis=0), dtype=np.float64)

    @property
    def final_orientation(self) -> Array:
        """Orientation (3, 3) of the tool at rest, to world from the tool."""
        return np.asarray(Rotation.from_rotvec(self._turns[-1, 0]).as_matrix() @ self._reference)


def plan_tool_motion(
    begin: ToolState, goal: Array, turn: Array, limits: Array, kinematics: HandKinematics, *, period: float
) -> ToolMotion | None:
    """Plan the motion to a place and an orientation; the wrist's own limits are not kept yet, see `Pace`.

    Args:
        goal: (joints - 3,) where the joints before the wrist come to rest [rad].
        turn: (3,) rotation vector of the tool from its present orientation, in axes of the world [rad].
        limits: (3, joints) of speed, acceleration and jerk of the joints before the wrist and of the tool's turn.
        kinematics: of the arm.
        period: between two samples [s].

    Returns:
        The motion, or None when there is nothing to move, Ruckig finds none, or the wrist cannot follow.
    """
    run = _state_to_rest(begin, goal, turn, limits)
    if run is None:
        return None
    count = max(MIN_PERIODS, int(np.ceil(run.duration / period)))
    instants = [min(k * period, run.duration) for k in range(count + 1)]
    rows = np.array([run.at_time(t)[:3] for t in instants])  # (n + 1, 3 derivatives, joints)
    rows[np.array(instants) == run.duration, 1:] = 0.0
    before_wrist = _neighbours(rows[:, :, :-WRIST])  # (n + 1, 3 instants, joints - 3)
    orientations = _orientations(rows[:, :, -WRIST:], begin.orientation)
    solved = kinematics.wrist(before_wrist.reshape(-1, len(goal)), orientations.reshape(-1, 3, 3), begin.joints[0])
    if solved is None:
        return None
    wrist = solved.reshape(-1, 3, WRIST)
    before, now, after = wrist[:, 0], wrist[:, 1], wrist[:, 2]
    bends = (after - 2 * now + before) / DIFFERENCE_STEP**2
    bends[rows[:, 1:].any(axis=(1, 2)) == 0] = 0.0
    accelerations = np.hstack([rows[:, 2, :-WRIST], bends])
    rest = np.hstack([rows[-1, 0, :-WRIST], now[-1]])
    joints = ConstantJerkMotion.near(begin.joints, accelerations, rest, period)
    return ToolMotion(joints, rows[1:, :, -WRIST:], begin.orientation)


def _state_to_rest(begin: ToolState, goal: Array, turn: Array, limits: Array) -> Trajectory | None:
    lead = len(goal)
    inputs = InputParameter(lead + WRIST)
    inputs.current_position = [*begin.joints[0, :lead], *ZERO_VELOCITY]
    inputs.current_velocity = [*begin.joints[1, :lead], *begin.turning[0]]
    inputs.current_acceleration = [*begin.joints[2, :lead], *begin.turning[1]]
    inputs.target_position = [*goal, *turn]
    inputs.max_velocity, inputs.max_acceleration, inputs.max_jerk = limits.tolist()
    run = Trajectory(lead + WRIST)
    try:
        result = Ruckig(lead + WRIST).calculate(inputs, run)
    except RuckigError:
        return None
    return run if result == Result.Working and run.duration > 0.0 else None


def _neighbours(rows: Array) -> Array:
    """Return values (n, 3 instants, m) just before, at and just after the instants of rows (n, 3 derivatives, m)."""
    place, rate, second = rows[:, 0], rows[:, 1], rows[:, 2] / 2
    h = DIFFERENCE_STEP
    return np.stack([place - h * rate + h * h * second, place, place + h * rate + h * h * second], axis=1)


def _orientations(turns: Array, reference: Array) -> Array:
    """Return orientations (n, 3 instants, 3, 3) just before, at and just after the instants of turns (n, 3, 3)."""
    vectors = _neighbours(turns)
    matrices = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix() @ reference
    return np.asarray(matrices.reshape(*vectors.shape[:2], 3, 3))
