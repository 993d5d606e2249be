"""What is learned: clusters, scores and paths."""

from __future__ import annotations

from dataclasses import dataclass, field

from teachpath.nurbs import Curve
from teachpath.records.arrays import Array, Matrix
from teachpath.records.motion import ObjectPose


@dataclass(frozen=True, slots=True)
class Deviation:
    """Where and how a demonstration deviates most from the others of its cluster."""

    share: tuple[float, float]  # begin and end as shares of the arc length
    seconds: tuple[float, float]  # begin and end since the first sample
    sentence: str


@dataclass(frozen=True, slots=True)
class Score:
    """The score of one demonstration in the selection of its cluster.

    Attributes:
        log_likelihood: of its observations under the models that score it.
        rank: 1 = most consistent.
        note: why it was not selected, or not scored.
        margin: distance to the next in rank, in robust z in mode default, else in log-likelihood; None for the last.
        z: its worst robust z, at most 0; 0 = consistent, None = not scored.
        stability: share of the repetitions in which it was selected; None when there were none.
        deviation: where it deviates most; None when it is consistent.
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
    """Demonstrations that do the task alike, with their scores.

    Attributes:
        members: ids, most consistent first.
        scores: same order as `members`.
        convergence: log-likelihood of the model after each training iteration (Fig. 4).
        note: why selection was skipped or is unreliable; empty when neither.
        representative: id of the member nearest to the mean of all; empty in runs of earlier versions.
        spread: (50,) radius [m], at equal arc lengths, of the tube around the learned path that holds the selected
            demonstrations.
        ambiguous: a sentence about what the next best cut would change, when the choice was close; else empty.
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
    """Distances [m] of a learned path from the points that it was fitted to, and from the demonstrations."""

    bound: float
    largest: float
    rms: float
    tube: float  # largest distance of a selected demonstration from the path
    frechet: float | None = None  # discrete Fréchet distance from the mean path
    turn: float | None = None  # largest angle [rad] of the orientations from the mean orientations


@dataclass(frozen=True, eq=False)
class LearnedPath:
    """The NURBS of one cluster: the path of the object's centre in the world.

    Attributes:
        version: see `Version`; the learned path itself is version 1.
        curve: positions [m].
        fit: None for an edited version, which follows no demonstrations.
        orientation: quaternions at the same parameter, which `nurbs.unit_quaternions` brings to unit length; None when
            not all selected demonstrations carry orientations.
        object_pose: where an adapted path takes the object; None = where the scene has it.
    """

    id: str
    run: str
    cluster: int
    version: int
    curve: Curve
    fit: Fit | None
    note: str = ""
    orientation: Curve | None = None
    object_pose: ObjectPose | None = None


@dataclass(frozen=True, eq=False)
class Learned:
    """The result of one learning run over a task's demonstrations.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them: left, right, height [m], size; leaves in the order of
            `demonstrations`.
        threshold: height of the cut [m].
        versions: of the libraries that computed the run.
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


@dataclass(frozen=True, slots=True)
class RunSummary:
    """A learning run as it is listed.

    Attributes:
        mode: of learning.
        demonstrations: how many it learned from.
        paths: ids of the learned paths, one for each cluster.
    """

    id: str
    task: str
    created_ns: int
    mode: str
    demonstrations: int
    paths: tuple[str, ...]
