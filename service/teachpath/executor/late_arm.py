"""Whether a motion waits for an arm that plays its setpoints late."""

from __future__ import annotations

from typing import Final

LATE_ARM_SUFFIX: Final = ", waiting for the arm, which is late"
MAX_ARM_LAG: Final = 0.3  # [s] by which an arm may play its setpoints late; a driver's delay and the bus take less
CAUGHT_UP_LAG: Final = 0.25  # [s] below which an arm that was late has caught up


def is_too_late(untaken: int, moving: int, rate: float, *, waits: bool) -> bool:
    """Tell whether the motion has to rest until the arm has caught up.

    Args:
        untaken: setpoints that were sent and that the arm has not taken up yet.
        moving: setpoints that were sent since the motion began: those before it was at rest delay no stop.
        rate: of the setpoints [1/s].
        waits: whether the motion waits already.
    """
    return untaken >= CAUGHT_UP_LAG * rate if waits else min(untaken, moving) > MAX_ARM_LAG * rate
