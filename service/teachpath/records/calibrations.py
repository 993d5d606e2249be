"""How a tracker's frame lies in the world, and what that was measured with."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records.arrays import Quaternion, Vector


@dataclass(frozen=True, slots=True)
class Calibration:
    """A named mapping to `world` from `tracker`: p_world = scale * R p_tracker + offset."""

    name: str
    scale: float = 1.0
    rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    offset: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class TaughtPoint:
    """One place that was shown to a tracker [m], and how far the mapping puts it from where it is [m]."""

    tracker: Vector
    world: Vector
    residual: float = 0.0


@dataclass(frozen=True, slots=True)
class MeasuredCalibration:
    """A calibration with its origin.

    Attributes:
        version: counts up by one each time the name is measured anew; 0: it is in the settings.
        points: what it was measured with; none when it is in the settings.
        rms: of their residuals [m].
        source: the tracker that was shown them.
    """

    calibration: Calibration
    version: int = 0
    points: tuple[TaughtPoint, ...] = ()
    rms: float = 0.0
    source: str = ""
    created_ns: int = 0
