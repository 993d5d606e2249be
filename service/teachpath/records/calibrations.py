"""How a tracker's frame lies in the world, and what that was measured with."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records.arrays import Quaternion, Vector


@dataclass(frozen=True, slots=True)
class Calibration:
    """A named mapping to `world` from `tracker`: p_world = scale * R p_tracker + offset.

    Attributes:
        name: of the mapping, e.g. lab, or lab@2 for a measured version.
        scale: metres in the world for one unit of the tracker.
        rotation: to world from tracker, unit quaternion w, x, y, z.
        offset: of the tracker's origin [m, world].
    """

    name: str
    scale: float = 1.0
    rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    offset: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class TaughtPoint:
    """One place that was shown to a tracker [m], and how far the mapping puts it from where it is [m].

    Attributes:
        tracker: where the tracker saw the place, in its frame and units.
        world: where the place is [m, world].
        residual: distance between the place and where the mapping puts it [m].
    """

    tracker: Vector
    world: Vector
    residual: float = 0.0


@dataclass(frozen=True, slots=True)
class MeasuredCalibration:
    """A calibration with its origin.

    Attributes:
        calibration: the mapping itself.
        version: counts up by one each time the name is measured anew; 0: it is in the settings.
        points: what it was measured with; none when it is in the settings.
        rms: of their residuals [m].
        source: the tracker that was shown them.
        created_ns: when it was measured [ns since the Unix epoch]; 0: it is in the settings.
        author: who measured it; empty: not said.
    """

    calibration: Calibration
    version: int = 0
    points: tuple[TaughtPoint, ...] = ()
    rms: float = 0.0
    source: str = ""
    created_ns: int = 0
    author: str = ""
