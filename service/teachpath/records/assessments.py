"""What a quick look at a path says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from teachpath.records.arrays import Array, Matrix, Vector

# Why the arm cannot follow a path at a place.
PathFault = Literal["reach", "limit", "turn", "singular", "collision", "start", "end"]


@dataclass(frozen=True, slots=True)
class Suggestion:
    """What to change on a path: a control point (from 0), the move proposed for it [m], and both in a sentence.

    Attributes:
        control_point: its number, from 0.
        move: proposed for it [m, world].
        sentence: both in words.
    """

    control_point: int
    move: Vector
    sentence: str


@dataclass(frozen=True, slots=True)
class Failure:
    """Where a path fails: the first sample and the stretch [m], why, and what to change.

    Attributes:
        fault: what is wrong there.
        s: arc length of the first sample that fails [m].
        interval: arc lengths between which the path fails [m].
        position: of the path where it first fails [m, world].
        reason: why, in words.
        suggestion: what to change.
    """

    fault: PathFault
    s: float
    interval: tuple[float, float]
    position: Vector
    reason: str
    suggestion: Suggestion


@dataclass(frozen=True, eq=False)
class Assessment:
    """A quick look at a path that is being edited: whether the arm could follow it. Only a plan certifies.

    Attributes:
        lengths: (n,) arc length of the samples [m].
        parameters: (n,) of the curve there.
        positions: (n, 3) of the path there [m, world].
        faults: (n,) what is wrong at each sample, empty when nothing.
        reach: (n,) how far the wrist is within the arm's reach [m]; negative when out of it.
        limits: (n,) how far the joints are from their nearest limit [rad]; negative beyond.
        singular: (n,) least singular value of the Jacobian.
        clearance: (n,) of arm and carried object to scene and self [m]; at most 0.5 is looked for.
        nearest: (n,) who comes nearest to whom, in words.
        branch: of the arm, in words.
        duration: at full speed, estimated [s]; None when the path fails.
        failure: where it fails first; None when nothing was found.
        sentence: all of this for the operator.
    """

    lengths: Array
    parameters: Array
    positions: Matrix
    faults: tuple[PathFault | Literal[""], ...]
    reach: Array
    limits: Array
    singular: Array
    clearance: Array
    nearest: tuple[str, ...]
    branch: str
    duration: float | None
    failure: Failure | None
    sentence: str
