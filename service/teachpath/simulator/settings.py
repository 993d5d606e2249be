"""How the simulated arm behaves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt, Le


@dataclass(frozen=True)
class SimulatorSettings:
    """How the simulated arm behaves."""

    # whether serve starts it; false where a driver of a real arm speaks in its place
    start: bool = True
    # [rad/s] of the three poles of the tracking error, all at one place
    bandwidth: Annotated[float, Gt(0), Le(150)] = 60.0
    # [s] that setpoints wait before they are played, so that one that was held up on its way still comes in time
    delay: Annotated[float, Ge(0.004), Le(0.2)] = 0.03
    # whether to ask for real-time scheduling, below that of the executor; nice -10 where it is refused
    realtime: bool = True
