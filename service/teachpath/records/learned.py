"""What is learned: clusters, scores and paths."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from teachpath.nurbs import Curve
from teachpath.records.arrays import Array, Matrix
from teachpath.records.motion import ObjectPose

LearningMode = Literal["default", "paper", "repaired"]


@dataclass(frozen=True, slots=True)
class Deviation:
    """Where and how a demonstration deviates most from the others of its cluster.

    Attributes:
        share: begin and end as shares of the arc length, 0 to 1.
        seconds: begin and end since the first sample [s].
        sentence: both in words.
    """

    share: tuple[float, float]
    seconds: tuple[float, float]
    sentence: str


@dataclass(frozen=True, slots=True)
class Score:
    """The score of one demonstration in the selection of its cluster.

    Attributes:
        demonstration: its id.
        log_likelihood: of its observations under the models that score it.
        rank: 1 = most consistent.
        selected: whether the path is fitted to it.
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
        index: its number in the run, from 1.
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
    """Distances [m] of a learned path from the points that it was fitted to, and from the demonstrations.

    Attributes:
        bound: to which the fit was refined [m].
        largest: largest distance of a fitted point from the path [m].
        rms: root mean square of these distances [m].
        tube: largest distance of a selected demonstration from the path [m].
        frechet: discrete Fréchet distance from the mean path [m]; None: not measured.
        turn: largest angle of the orientations from the mean orientations [rad]; None: the path has none.
    """

    bound: float
    largest: float
    rms: float
    tube: float
    frechet: float | None = None
    turn: float | None = None


@dataclass(frozen=True, eq=False)
class LearnedPath:
    """The NURBS of one cluster: the path of the object's centre in the world.

    Attributes:
        id: of the path.
        run: id of the learning run.
        cluster: number of the cluster in the run.
        version: see `Version`; the learned path itself is version 1.
        curve: positions of the object's centre [m, world].
        fit: None for an edited version, which follows no demonstrations.
        note: what one should know of the fit, in words; empty: nothing.
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
        mode: of learning; paper is as it was published.
        demonstrations: ids, as they are numbered in `linkage`.
        linkage: (m - 1, 4) merges as scipy writes them: left, right, height [m], size; leaves in the order of
            `demonstrations`.
        threshold: height of the cut [m].
        clusters: the different ways in which the task was done.
        paths: one for each cluster.
        notes: what an operator should know of the run, in words.
        settings: of learning, with which it was computed.
        versions: of the libraries that computed the run.
        inputs: SHA-256 of every demonstration's times, positions and orientations, by id.
    """

    mode: LearningMode
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
        id: of the run.
        task: name of the task.
        created_ns: when it was made [ns since the Unix epoch].
        mode: of learning; paper is as it was published.
        demonstrations: how many it learned from.
        paths: ids of the learned paths, one for each cluster.
    """

    id: str
    task: str
    created_ns: int
    mode: LearningMode
    demonstrations: int
    paths: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PathSummary:
    """A learned path as it is listed.

    Attributes:
        id: of the path.
        task: whose demonstrations it was learned from.
        run: id of the learning run.
        cluster: number of the cluster in the run.
        versions: how many there are, the learned one among them.
        created_ns: when it was learned [ns since the Unix epoch].
    """

    id: str
    task: str
    run: str
    cluster: int
    versions: int
    created_ns: int


@dataclass(frozen=True, slots=True)
class PlanSummary:
    """A plan as it is listed.

    Attributes:
        id: of the plan.
        task: whose path it follows.
        path: id of the path.
        path_version: number of the path's version.
        scene: name of the scene that it was checked against.
        duration: of the path at full speed [s].
        clearance: least distance of arm and object to scene and self [m].
        revoked: whether its certificate was taken back.
        created_ns: when it was made [ns since the Unix epoch].
        author: who had it planned, where the station asks; empty: not said.
    """

    id: str
    task: str
    path: str
    path_version: int
    scene: str
    duration: float
    clearance: float
    revoked: bool
    created_ns: int
    author: str = ""
