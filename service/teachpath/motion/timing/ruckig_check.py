"""Compares the closed form of a ramp with Ruckig's."""

from __future__ import annotations

from typing import Final

from ruckig import ControlInterface, InputParameter, Result, Ruckig, RuckigError, Trajectory

from teachpath.motion.arm.puma560 import Array

RUCKIG_MARGIN: Final = 1 + 1e-12  # factor on Ruckig's limits, so that rounding makes no ramp infeasible
DURATION_TOLERANCE: Final = 1e-6  # [s] between the closed form of a ramp and Ruckig's


class RuckigCheck:
    """Asks Ruckig for ramps of three phases."""

    def __init__(self) -> None:
        """Begin without a ramp."""
        self._ruckig, self._inputs, self._answer = Ruckig(1), InputParameter(1), Trajectory(1)
        self._inputs.control_interface = ControlInterface.Velocity
        self._inputs.target_acceleration = [0.0]

    def agrees(self, ramp: Array, peak: float) -> bool:
        """Tell whether Ruckig finds a ramp (8,) of the same duration (see `kernels`).

        Args:
            peak: largest |r'| of the ramp [1/s].
        """
        inputs = self._inputs
        inputs.current_position, inputs.current_velocity = [float(ramp[0])], [float(ramp[1])]
        inputs.current_acceleration, inputs.target_velocity = [float(ramp[2])], [float(ramp[7])]
        # The limit on the side of the present acceleration includes that acceleration: with a lower one Ruckig would
        # brake first, and with the same limit on the other side it would go beyond the peak.
        along, against = peak * RUCKIG_MARGIN, max(peak, abs(float(ramp[2]))) * RUCKIG_MARGIN
        upward, downward = (along, against) if ramp[6] > 0.0 else (against, along)
        inputs.max_acceleration, inputs.min_acceleration = [upward], [-downward]
        inputs.max_jerk = [abs(float(ramp[6]))]
        try:
            result = self._ruckig.calculate(inputs, self._answer)
        except RuckigError:
            return False
        closed_form = float(ramp[3] + ramp[4] + ramp[5])
        return bool(result == Result.Working and abs(self._answer.duration - closed_form) <= DURATION_TOLERANCE)
