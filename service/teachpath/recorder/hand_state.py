"""The newest sample of a hand, which is looked at a few times a second, as what is drawn of it."""

from __future__ import annotations

from collections.abc import Sequence

from teachpath.recording.demonstration import object_pose
from teachpath.records import Calibration, Pose, Sample, Vector


class NewestSample:
    """Remembers where the newest sample is kept, so that it is made only when somebody asks."""

    def __init__(self) -> None:
        self._kept: tuple[Sequence[Sample], int] | None = None

    def keep(self, samples: Sequence[Sample], index: int = 0) -> None:
        """Remember one of some samples."""
        self._kept = samples, index

    def read(self) -> Sample | None:
        """Return it; None before the first."""
        return None if self._kept is None else self._kept[0][self._kept[1]]


def carried_pose(grasped: Sample | None, newest: Sample, calibration: Calibration, start: Vector | None) -> Pose | None:
    """Return the object's pose in the hand, to world from object; None where it is not carried or cannot be computed.

    Args:
        grasped: the sample with which the hand grasped it; None: it has not.
        start: of the object's centre [m, world]; None: there is none.
    """
    if grasped is None or start is None:
        return None
    return object_pose(grasped, newest, calibration, start)
