"""What is learned: clusters, scores and paths."""

from __future__ import annotations

from dataclasses import dataclass, field

from teachpath.nurbs import Curve
from teachpath.records.arrays import Array, Matrix


@dataclass(frozen=True, slots=True)
class Deviation:
    """Where and how a demonstration differs most from the others of its cluster."""

    share: tuple[float, float]  # of the length of its path, from and to
    seconds: tuple[float, float]  # since its first sample, from and to
    sentence: str


@dataclass(frozen=True, slots=True)
class Score:
    """How one demonstration fares in the selection of its cluster.

    Attributes:
        log_likelihood: of its observations under the model that judges it.
        rank: 1 = most consistent.
        note: why it was not selected, or not scored.
        margin: by how much it is better than the next in rank: robust z in mode default, else log-likelihood; None for
            the last.
        z: robust z score of its consistency, 0 = like the others or better; None when not scored.
        stability: share of repetitions in which it was selected; None when there were none.
        deviation: where it differs most; None when it is consistent.
    """

    demonstration: str
    log_likelihood: float
    rank: int
    selected: bool
    note: str = ""
    margin: float | None = None
    z: float | None = None
    stability: float | None = None
    deviation: Deviation | None = None


@dataclass(frozen=True, eq=False)
class Cluster:
    """One way of doing the task.

    Attributes:
        members: ids, most consistent first.
        scores: same order as `members`.
        convergence: log-likelihood of the model after each training iteration (Fig. 4).
        note: why selection was skipped or is unreliable; empty when neither.
        representative: id of the member nearest to the mean of all; empty in runs of earlier versions.
        spread: (50,) radius [m] at equal arc length of the tube around the learned path in which the selected
            demonstrations lie.
        ambiguous: what the next best cut would do with it, when the choice was close; else empty.
    """

    index: int
    members: tuple[str, ...]
    scores: tuple[Score, ...]
    convergence: tuple[float, ...] = ()
    note: str = ""
    representative: str = ""
    spread: Array | None = None
    ambiguous: str = ""


@dataclass(frozen=True, slots=True)
class Fit:
    """How closely a learned path follows what it was fitted to: distances [m]."""

    bound: float
    largest: float
    rms: float
    tube: float  # largest distance of a selected demonstration from the path
    frechet: float | None = None  # distance when both are walked along in order
    turn: float | None = None  # largest angle of the orientations from what they were fitted to [rad]


@dataclass(frozen=True, eq=False)
class LearnedPath:
    """The NURBS of one cluster: the way of the object's centre in the world.

    Attributes:
        version: see `Version`; what was learned is version 1.
        curve: positions [m].
        fit: None for an edited version: it follows an operator's wish, no demonstrations.
        orientation: quaternions at the same parameter, which `nurbs.unit_quaternions` brings to unit length; None when
            not all selected demonstrations carry orientations.
    """

    id: str
    run: str
    cluster: int
    version: int
    curve: Curve
    fit: Fit | None
    note: str = ""
    orientation: Curve | None = None


@dataclass(frozen=True, eq=False)
class Learned:
    """The result of one learning run over a task's demonstrations.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them: left, right, height [m], size; leaves in the order of
            `demonstrations`.
        threshold: height of the cut [m].
        versions: library versions that made it.
        inputs: SHA-256 of every demonstration's times, positions and orientations, by id.
    """

    mode: str
    demonstrations: tuple[str, ...]
    linkage: Matrix
    threshold: float
    clusters: tuple[Cluster, ...]
    paths: tuple[LearnedPath, ...]
    notes: tuple[str, ...] = ()
    settings: dict[str, object] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    inputs: dict[str, str] = field(default_factory=dict)
