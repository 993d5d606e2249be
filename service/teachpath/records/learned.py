"""What is learned: clusters, scores and paths."""

from __future__ import annotations

from dataclasses import dataclass, field

from teachpath.nurbs import Curve
from teachpath.records.arrays import Array


@dataclass(frozen=True, slots=True)
class Score:
    """How one demonstration fares in the selection of its cluster."""

    demonstration: str
    log_likelihood: float
    rank: int  # 1 = most consistent
    selected: bool
    note: str = ""


@dataclass(frozen=True, eq=False)
class Cluster:
    """One way of doing the task.

    Attributes:
        members: ids, most consistent first.
        scores: same order as `members`.
        convergence: log-likelihood of the model after each training iteration (Fig. 4).
        note: why selection was skipped or is unreliable; empty when neither.
    """

    index: int
    members: tuple[str, ...]
    scores: tuple[Score, ...]
    convergence: tuple[float, ...] = ()
    note: str = ""


@dataclass(frozen=True, slots=True)
class Fit:
    """How closely a learned path follows what it was fitted to: distances [m]."""

    bound: float
    largest: float
    rms: float
    tube: float  # largest distance of a selected demonstration from the path


@dataclass(frozen=True, eq=False)
class LearnedPath:
    """The NURBS of one cluster: the way of the object's centre in the world."""

    id: str
    run: str
    cluster: int
    version: int
    curve: Curve
    fit: Fit
    note: str = ""


@dataclass(frozen=True, eq=False)
class Learned:
    """The result of one learning run over a task's demonstrations.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them: left, right, height [m], size; leaves in the order of
            `demonstrations`.
        threshold: height of the cut [m].
        versions: library versions that made it.
    """

    mode: str
    demonstrations: tuple[str, ...]
    linkage: Array
    threshold: float
    clusters: tuple[Cluster, ...]
    paths: tuple[LearnedPath, ...]
    notes: tuple[str, ...] = ()
    settings: dict[str, object] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
