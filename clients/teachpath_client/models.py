"""What a station answers: frozen records with the names and types of the REST API.

Generated from its description by `python -m tests.contract.openapi`; do not edit. Metres, radians, seconds; quaternions
w, x, y, z; times that end in `_ns` are nanoseconds since the Unix epoch.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

ExecutorState = Literal["idle", "starting", "approaching", "following", "held", "stopping", "ended", "faulted"]

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled"]

Verdict = Literal["clean", "repaired", "reject"]


@dataclass(frozen=True)
class Adaptation:
    """A path that was adapted to another start and goal.

    Attributes:
        version: that was saved, or the base itself when it begins and ends there already.
        path: of that version.
        spread: two standard deviations [m] of a demonstration between these ends from the path, at 100 equal
            arc lengths.
        demonstrations: how many the shape was learned from.
        places: at how many different starts or goals these were shown.
        extrapolates: what is beyond the shown range; empty within it.
        note: how sure the adaptation is, in words.
        job: that certifies the version; its outcome is a plan.
    """

    version: Version
    path: LearnedPath
    spread: list[float]
    demonstrations: int
    places: int
    extrapolates: str
    note: str
    job: Job


@dataclass(frozen=True)
class AdaptationModel:
    """What a course between other ends is computed from: the numbers of a `CourseModel`, for programs beside this one.

    Attributes:
        turns: False for closed or vertical paths, whose shapes s_i are added as they are, without D and R.
        shapes: of each demonstration (n, 3), in the axes of the world.
        distances: of each demonstration D [m].
        yaws: of each demonstration y [rad].
        inverse: of the kriging system.
        variance: (n,) per unit of scale and of kriging variance; None after one demonstration.
        learned: (n, 3) [m] the path as it was learned.
        own: (n, 3) [m] what it has beside the prediction for its ends.
        version: (n, 3) [m] the version that is adapted.
        edits: (n, 3) [m] what it has beside the adapted learned path.
    """

    turns: bool
    shapes: list[list[list[float]]]
    distances: list[float]
    yaws: list[float]
    inverse: list[list[float]]
    variance: list[float] | None
    learned: list[list[float]]
    own: list[list[float]]
    version: list[list[float]]
    edits: list[list[float]]


@dataclass(frozen=True)
class Advice:
    """What the operator of a task should do next, in words."""

    task: str
    sentence: str


@dataclass(frozen=True)
class Assessment:
    """A quick look at a path that is being edited: whether the arm could follow it. Only a plan certifies.

    Attributes:
        lengths: (n,) arc length of the samples [m].
        parameters: (n,) of the curve there.
        positions: (n, 3) [m].
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

    lengths: list[float]
    parameters: list[float]
    positions: list[list[float]]
    faults: list[str]
    reach: list[float]
    limits: list[float]
    singular: list[float]
    clearance: list[float]
    nearest: list[str]
    branch: str
    duration: float | None
    failure: Failure | None
    sentence: str


@dataclass(frozen=True)
class BusSettings:
    """Where the Zenoh session of this process meets the others."""

    endpoint: str = "tcp/127.0.0.1:7447"
    prefix: str = "teachpath/station"
    robot: str = "puma560"
    access_control: bool = True
    certificates: str = "teachpath-certificates"
    router: bool = False
    connect_timeout: float = 10.0


@dataclass(frozen=True)
class Calibration:
    """A named mapping to `world` from `tracker`: p_world = scale * R p_tracker + offset."""

    name: str
    scale: float = 1.0
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Certificate:
    """The proof that the arm can follow a plan; uses are shares of the limits, at most 1."""

    digest: str
    branch: str
    position_use: Extreme
    velocity_use: Extreme
    acceleration_use: Extreme
    jerk_use: Extreme
    torque_use: Extreme
    least_singular: Extreme
    clearance: Extreme
    tool_speed: Extreme | None = None
    signature: Signature | None = None


@dataclass(frozen=True)
class Clock:
    """The clock of a device against the host's.

    Attributes:
        offset_ns: host clock minus device clock at the newest sample. It includes the minimum one-way transit time,
            which cannot be observed without a round trip.
        uncertainty_ns: median transit time minus the minimum.
        rate: seconds of the device's clock in one second of the host's.
    """

    offset_ns: int
    uncertainty_ns: int
    rate: float


@dataclass(frozen=True)
class Cluster:
    """Demonstrations that do the task alike, with their scores.

    Attributes:
        members: ids, most consistent first.
        scores: same order as `members`.
        convergence: log-likelihood of the model after each training iteration (Fig. 4).
        note: why selection was skipped or is unreliable; empty when neither.
        representative: id of the member nearest to the mean of all; empty in runs of earlier versions.
        spread: (50,) radius [m], at equal arc lengths, of the tube around the learned path that holds the
            selected demonstrations.
        ambiguous: a sentence about what the next best cut would change, when the choice was close; else empty.
    """

    index: int
    members: list[str]
    scores: list[Score]
    convergence: list[float]
    note: str
    representative: str
    spread: list[float] | None
    ambiguous: str


@dataclass(frozen=True)
class ControlPointChange:
    """One control point that differs between two curves.

    Attributes:
        number: in the second curve, from 1.
        distance: between both positions [m].
        weights: before and after.
    """

    number: int
    distance: float
    weights: tuple[float, float]


@dataclass(frozen=True)
class Curve:
    """A clamped NURBS on the parameter range [0, 1].

    Attributes:
        degree: p, 1 to 7.
        knots: (n + p + 1,) non-decreasing, p + 1 times 0 first and p + 1 times 1 last.
        control_points: (n, d) [m], or of a curve of quaternions (n, 4).
        weights: (n,) positive.
    """

    degree: int
    knots: list[float]
    control_points: list[list[float]]
    weights: list[float]


@dataclass(frozen=True)
class Cut:
    """One possible cut.

    Attributes:
        clusters: their number.
        lowest, highest: heights [m] between which a cut leaves that many; None = no upper end.
        height: halfway between them [m].
        leaf_ranges: for each cluster, in the order of its number, the begin and end of its members in the dendrogram's
            `leaves`; the end is excluded.
    """

    clusters: int
    lowest: float
    highest: float | None
    height: float
    leaf_ranges: list[tuple[int, int]]


@dataclass(frozen=True)
class Demonstration:
    """One trial, as a row: the samples are in its recording file.

    The transport phase is samples[grasp:release] of the recording, or samples[trim[0]:trim[1]] when the operator has
    trimmed it.
    """

    id: str
    task: str
    number: int
    source: str
    calibration: Calibration
    created_ns: int
    duration: float
    samples: int
    grasp: int
    release: int
    verdict: Verdict
    statistics: StreamStatistics
    recording: str
    reasons: list[str] = field(default_factory=list)
    advice: str = ""
    left_out: list[int] = field(default_factory=list)
    trim: tuple[int, int] | None = None
    mark: str = ""
    discarded_ns: int = 0
    digest: RecordingDigest | None = None
    object_pose: ObjectPose | None = None


@dataclass(frozen=True)
class Dendrogram:
    """The dendrogram of a run, ready to be drawn.

    Attributes:
        demonstrations: ids in the order of their numbers in `merges`, 0 to m - 1.
        leaves: ids from left to right; no merge crosses another, and the members of every cluster are neighbours.
        merges: left, right, height [m] and number of members, as scipy writes them; merge i has the number m + i.
        threshold: height of the run's own cut [m].
        clusters: number of clusters of the run's own cut.
        cuts: the possible cuts, from one cluster on.
    """

    demonstrations: list[str]
    leaves: list[str]
    merges: list[tuple[int, int, float, int]]
    threshold: float
    clusters: int
    cuts: list[Cut]


@dataclass(frozen=True)
class Deviation:
    """Where and how a demonstration deviates most from the others of its cluster."""

    share: tuple[float, float]
    seconds: tuple[float, float]
    sentence: str


@dataclass(frozen=True)
class Difference:
    """The difference between two curves.

    Attributes:
        largest: Hausdorff distance of the curves [m].
        mean: distance of the points of each curve from the other curve, averaged over both curves [m].
        s: arc length on the second curve at the largest distance [m].
        moved: control points that differ, on the second curve's knots; None when they cannot be matched.
        sentence: the difference in words.
    """

    largest: float
    mean: float
    s: float
    moved: list[ControlPointChange] | None
    sentence: str


@dataclass(frozen=True)
class EditResult:
    """A curve after an operation, and its largest distance [m] from the curve before, measured at 401 parameters."""

    curve: Curve
    deviation: float


@dataclass(frozen=True)
class Execution:
    """An execution as stored; `plan` is None when the arm followed a live hand."""

    id: str
    plan: str | None
    created_ns: int
    status: ExecutorStatus


@dataclass(frozen=True)
class ExecutorStatus:
    """Where an execution stands; see proto/teachpath_proto/motion.proto for the fields."""

    execution: str = ""
    state: ExecutorState = "idle"
    reason: str = ""
    progress: float = 0.0
    override: float = 1.0
    cycles: int = 0
    late: int = 0
    missed: int = 0
    lateness_p50_us: float = 0.0
    lateness_p99_us: float = 0.0
    lateness_max_us: float = 0.0
    limit_use: float = 0.0
    tracking_error: float = 0.0
    limit_place: str = ""
    duration: float = 0.0
    length: float = 0.0
    activity: str = ""
    operator: str = ""
    asking: str = ""
    scheduling: str = ""
    hand_latency_p50_us: float = 0.0
    hand_latency_p99_us: float = 0.0
    ending: bool = False
    unasked_motion: str = ""


@dataclass(frozen=True)
class Extreme:
    """A largest or least value on a path and where it occurs."""

    value: float
    place: str
    s: float


@dataclass(frozen=True)
class Failure:
    """Where a path fails: the first sample and the stretch [m], why, and what to change."""

    fault: str
    s: float
    interval: tuple[float, float]
    position: tuple[float, float, float]
    reason: str
    suggestion: Suggestion


@dataclass(frozen=True)
class Fault:
    """One field of a request that cannot be used.

    Attributes:
        place: where it is, e.g. body.override
    """

    place: str
    fault: str


@dataclass(frozen=True)
class Fit:
    """Distances [m] of a learned path from the points that it was fitted to, and from the demonstrations."""

    bound: float
    largest: float
    rms: float
    tube: float
    frechet: float | None = None
    turn: float | None = None


@dataclass(frozen=True)
class Health:
    """Which parts of a station run, and what an operator should know.

    Attributes:
        uptime: since the station was opened [s].
        processes: of each process beside the service, whether it is `running`, `restarting` or has `ended`.
        recording: trackers that are being recorded.
        backlog: samples that wait for the recorder.
        executor: None until it has said something.
        notes: in words, what needs somebody.
    """

    version: str
    uptime: float
    bus: BusSettings
    processes: dict[str, str]
    recording: list[str]
    backlog: int
    longest_backlog: int
    trackers: list[Tracker]
    guidance: Advice
    executor: ExecutorStatus | None
    notes: list[str]


@dataclass(frozen=True)
class Job:
    """Background work on a task: `learn`, `recut`, `plan` or `import`.

    Attributes:
        message: what it does now, or why it failed.
        outcome: id of the run or plan that it made; of an import the numbers of the first and the last
            demonstration, e.g. `3-5`.
        failure: where a path fails that the arm cannot follow, why, and what to change.
        demonstration: id of the one because of which nothing could be learned.
    """

    id: str
    task: str
    kind: str
    request: dict[str, Any]
    state: JobState
    fraction: float
    message: str
    outcome: str
    attempt: int
    created_ns: int
    finished_ns: int
    failure: Failure | None = None
    demonstration: str = ""


@dataclass(frozen=True)
class JournalEntry:
    """Who did what to the arm, and how that was answered."""

    at_ns: int
    who: str
    verb: str
    execution: str
    answer: str


@dataclass(frozen=True)
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
    demonstrations: list[str]
    linkage: list[list[float]]
    threshold: float
    clusters: list[Cluster]
    paths: list[LearnedPath]
    notes: list[str]
    settings: dict[str, Any]
    versions: dict[str, str]
    inputs: dict[str, str]


@dataclass(frozen=True)
class LearnedPath:
    """The NURBS of one cluster: the path of the object's centre in the world.

    Attributes:
        version: see `Version`; the learned path itself is version 1.
        curve: positions [m].
        fit: None for an edited version, which follows no demonstrations.
        orientation: quaternions at the same parameter, which `nurbs.unit_quaternions` brings to unit length;
            None when not all selected demonstrations carry orientations.
        object_pose: where an adapted path takes the object; None = where the scene has it.
    """

    id: str
    run: str
    cluster: int
    version: int
    curve: Curve
    fit: Fit | None
    note: str
    orientation: Curve | None
    object_pose: ObjectPose | None


@dataclass(frozen=True)
class Lease:
    """Who is in control; `token` is told only to whom it belongs."""

    holder: str = ""
    expires_in: float = 0.0
    hold_when_lost: bool = False
    asking: str = ""
    granted_in: float = 0.0
    token: str = ""


@dataclass(frozen=True)
class LinkGeometry:
    """A link by its standard Denavit-Hartenberg parameters: a and d [m], alpha [rad]."""

    a: float
    d: float
    alpha: float


@dataclass(frozen=True)
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
    points: list[TaughtPoint] = field(default_factory=list)
    rms: float = 0.0
    source: str = ""
    created_ns: int = 0


@dataclass(frozen=True)
class MotionPreview:
    """The motion at full speed from the arm's home, at even instants.

    Attributes:
        times: (n,) [s], from 0.
        joints: (n, 6) configurations [rad].
        progress: (n,) share of the learned path's length that is done.
        gripper_closed: (n,)
        object_position: (n, 3) centre of the carried object [m, world]; (0, 3) when the scene has none.
        object_orientation: (n, 4) w, x, y, z; (0, 4) when the scene has none.
        segments: what the arm does when.
    """

    plan: str
    times: list[float]
    joints: list[list[float]]
    progress: list[float]
    gripper_closed: list[bool]
    object_position: list[list[float]]
    object_orientation: list[list[float]]
    segments: list[SegmentInterval]


@dataclass(frozen=True)
class ObjectPose:
    """Where the object of a scene lies: its centre [m, world], and its orientation w, x, y, z."""

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Plan:
    """Path plus timing plus certificate: all that the executor needs.

    Attributes:
        lengths: (n,) arc length of the nodes [m], from 0, strictly increasing.
        joints: (n, 6) configurations at the nodes [rad]; between them a quintic spline runs, on even parameters
            from 0 to 1.
        squared_rates: (m,) coefficients of the square of the parameter's rate at full speed, a quadratic spline
            on even intervals [1/s^2].
        limits: (3, 6) of the joints' speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] while they follow
            the path, at any override.
        above_start: (6,) configuration above the start, from where the object is grasped.
        above_goal: (6,) configuration above the goal, to where the arm retreats.
        duration: of the path at full speed [s].
        tool_speed: limit of elbow, wrist and tool centre point [m/s], at any override; None: no limit.
    """

    id: str
    path: str
    path_version: int
    scene: Scene
    lengths: list[float]
    joints: list[list[float]]
    squared_rates: list[float]
    limits: list[list[float]]
    above_start: list[float]
    above_goal: list[float]
    duration: float
    certificate: Certificate
    tool_speed: float | None


@dataclass(frozen=True)
class Probe:
    """That the service lives, or is ready.

    Attributes:
        version: of the service.
    """

    version: str


@dataclass(frozen=True)
class RecordingDigest:
    """What a recording's file is known by.

    Attributes:
        sha256: of the whole file, hexadecimal.
        size: of the file [bytes].
        samples: their count, each as often as it came.
        first: lowest number of a sample; 0 where there is none.
        last: highest number of a sample; 0 where there is none.
    """

    sha256: str
    size: int
    samples: int
    first: int
    last: int


@dataclass(frozen=True)
class RecordingReport:
    """The account of a recording: all samples that came, and all that did not; times in nanoseconds.

    Attributes:
        demonstrations: ids of those made so far, in order.
        missing: first and last of the numbers that never came, of the first 20 gaps.
        idle: samples that belong to no demonstration.
        gaps: stretches of numbers that never came.
        conflicts: samples whose number was taken, or contradicts their device time.
        late: samples that came after the demonstration they belong to was cut, which is made without them.
        declared_rate: [Hz] that the client said; 0: none.
        seen_rate: [Hz] numbers a second of the device's clock.
        clock_offset_ns: host clock minus device clock, with the least transit in it.
        clock_rate: seconds of the device's clock in one of the host's; 0: not known.
        phase: of the hand; empty when the recording has ended.
        state: recording, countdown, pausing, paused or lost; empty when the recording has ended.
        pedal_used: whether the pedal has been pressed in this recording.
        countdown_left: [s] until samples are recorded.
        takes_left: demonstrations until it pauses by itself; 0: nobody has said how many.
        pending_command: what the fist that is held now commands when it opens: toggle, discard or nothing.
        notes: what an operator should know, in words.
    """

    task: str
    tracker: str
    demonstrations: list[str]
    received: int
    lost: int
    duplicated: int
    reordered: int
    late: int
    refused: int
    untracked: int
    gaps: int
    missing: list[tuple[int, int]]
    longest_gap_ns: int
    conflicts: int
    clock_jumps: int
    declared_rate: float
    seen_rate: float
    clock_offset_ns: int
    clock_uncertainty_ns: int
    clock_rate: float
    idle: int
    phase: str
    state: str
    pedal_used: bool
    countdown_left: float
    takes_left: int
    pending_command: str
    notes: list[str]


@dataclass(frozen=True)
class Refusal:
    """Why a request was refused.

    Attributes:
        detail: a sentence for the operator: value, limit, place, way out
        error: kind of the error
        errors: the unusable fields of the request, at most 20, when that is the reason
        newer: the version saved meanwhile, when that is the reason
        failure: where the path fails, why, and which control point to move
        demonstration: id of the demonstration that is to blame
    """

    detail: str
    error: str
    errors: list[Fault] = field(default_factory=list)
    newer: Version | None = None
    failure: Failure | None = None
    demonstration: str = ""


@dataclass(frozen=True)
class Robot:
    """How the arm is built.

    Attributes:
        name: of the arm in its keys.
        variant: the published table that its lengths and masses come from.
        links: from the base to the wrist.
        lower: (6,) limits of the joints [rad].
        upper: (6,) likewise.
        speed: (6,) limits [rad/s].
        acceleration: (6,) limits [rad/s^2].
        jerk: (6,) limits [rad/s^3].
        torque: (6,) limits [N m].
        tool_length: from the flange to the tool centre point [m].
        finger_travel: of each finger [m].
        home: configuration in which the arm waits [rad].
        tool_speed: limit of elbow, wrist and tool centre point [m/s]; None: no limit.
        payload_mass: of what the flange carries besides the gripper and the scene's object [kg].
        payload_center: its centre of mass in the flange's frame [m].
    """

    name: str
    variant: str
    links: list[LinkGeometry]
    lower: list[float]
    upper: list[float]
    speed: list[float]
    acceleration: list[float]
    jerk: list[float]
    torque: list[float]
    tool_length: float
    finger_travel: float
    home: list[float]
    tool_speed: float | None
    payload_mass: float
    payload_center: list[float]


@dataclass(frozen=True)
class Run:
    """A learning run as stored."""

    id: str
    task: str
    created_ns: int
    learned: Learned


@dataclass(frozen=True)
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
    paths: list[str]


@dataclass(frozen=True)
class SavedVersion:
    """A version of a learned path, and the path itself."""

    version: Version
    path: LearnedPath


@dataclass(frozen=True)
class Scene:
    """What stands around the arm. Obstacles include the table; `carried` is the object at its start, or None.

    Arm, gripper and carried object stay above the floor, inside every box of `keep_in` and out of every shape of
    `keep_out`; nothing stands in these zones, they are rules.

    Attributes:
        floor: height of the floor [m, world]; the arm's foot stands at 0.
        keep_in: boxes.
        keep_out: shapes of any kind.
    """

    name: str
    obstacles: list[Shape] = field(default_factory=list)
    carried: Shape | None = None
    floor: float = 0.0
    keep_in: list[Shape] = field(default_factory=list)
    keep_out: list[Shape] = field(default_factory=list)


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class SegmentInterval:
    """When a stretch of the motion lasts, in words and seconds."""

    name: str
    begin: float
    end: float


@dataclass(frozen=True)
class Shape:
    """One body of a scene.

    Attributes:
        kind: `box` (size: full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius) or
            `mesh` (factor from its units to metres).
        size: what its kind says [m].
        position: of its centre, of a mesh its origin [m].
        orientation: of the shape in the world.
        file: OBJ or STL file of a mesh, beside the settings.
        vertices: of the mesh's convex hull, which takes its place: three a triangle, in the file's units.
    """

    name: str
    kind: str
    size: list[float]
    position: tuple[float, float, float]
    color: int = 8425632
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    file: str = ""
    vertices: list[tuple[float, float, float]] = field(default_factory=list)


@dataclass(frozen=True)
class Signature:
    """What a station says with its key of a plan: that it made the plan, and what the certificate holds for.

    Attributes:
        arm: name of the published variant.
        tool_length: from the flange to the grasp point [m].
        settings: `motion` settings with which the plan was made.
        calibrations: of the demonstrations that the path was learned from.
        present_calibrations: the newest versions of these when the plan was made.
        issued_ns: when the plan was made.
        expires_ns: when the certificate holds no longer.
        mac: HMAC-SHA256 (hex) over the whole plan and the arm, by the station's signing key.
    """

    arm: str
    tool_length: float
    settings: dict[str, Any]
    calibrations: list[Calibration]
    present_calibrations: list[Calibration]
    issued_ns: int
    expires_ns: int
    mac: str


@dataclass(frozen=True)
class StreamStatistics:
    """Counts of the samples of one recording or demonstration.

    All from `outliers` to `measured_rate` are of the transport phase only. Numbers that were sent are received, less
    the duplicated and conflicting, or lost, or refused.
    """

    received: int = 0
    lost: int = 0
    duplicated: int = 0
    reordered: int = 0
    late: int = 0
    refused: int = 0
    refused_numbers: list[tuple[int, int]] = field(default_factory=list)
    untracked: int = 0
    gaps: int = 0
    missing: list[tuple[int, int]] = field(default_factory=list)
    longest_gap_ns: int = 0
    outliers: int = 0
    level_shifts: int = 0
    out_of_workspace: int = 0
    reversals: int = 0
    repeated: int = 0
    longest_freeze_ns: int = 0
    freeze_at_ns: int = 0
    measured_rate: float = 0.0
    conflicts: int = 0
    flaps: int = 0
    flap_at_ns: int = 0
    regrasp_ns: int = 0
    clock_jumps: int = 0
    declared_rate: float = 0.0
    seen_rate: float = 0.0
    clock: Clock | None = None
    notes: list[str] = field(default_factory=list)
    dwell_times: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Suggestion:
    """What to change on a path: a control point (from 0), the move proposed for it [m], and both in a sentence."""

    control_point: int
    move: tuple[float, float, float]
    sentence: str


@dataclass(frozen=True)
class Task:
    """What is demonstrated: its name, its scene and the calibration of its demonstrations.

    Attributes:
        object_at_grasp: whether the object lies where the hand grasps, anew in each demonstration, instead of where
            the scene has it.
    """

    name: str
    scene: str
    calibration: str
    created_ns: int
    object_at_grasp: bool = False


@dataclass(frozen=True)
class TaughtPoint:
    """One place that was shown to a tracker [m], and how far the mapping puts it from where it is [m]."""

    tracker: tuple[float, float, float]
    world: tuple[float, float, float]
    residual: float = 0.0


@dataclass(frozen=True)
class TimeSeries:
    """A recorded motion over time.

    Attributes:
        times: (n,) since the first setpoint [s].
        positions: (n, 6) of the joints [rad].
        velocities: (n, 6), each the one of largest magnitude since the time before [rad/s].
        torques: (n, 6), likewise [N m].
        tool: (n, 3) grasp point [m], world.
        object: (n, 3) carried object [m], world; empty when there is none.
        gripper_closed: (n,).
        tracking_error: (n,) largest since the time before [rad].
        lateness: (n,) of the setpoints sent since the time before, the largest [s]; 0 where none was sent.
    """

    times: list[float]
    positions: list[list[float]]
    velocities: list[list[float]]
    torques: list[list[float]]
    tool: list[list[float]]
    object: list[list[float]]
    gripper_closed: list[bool]
    tracking_error: list[float]
    lateness: list[float]


@dataclass(frozen=True)
class Tracker:
    """A tracker that is there."""

    name: str
    announced: bool
    silence: float


@dataclass(frozen=True)
class Trajectory:
    """The object's motion in its transport phase, world frame.

    Attributes:
        times: (n,) [s], from 0, strictly increasing (device clock).
        positions: (n, 3) [m].
        orientations: (n, 4) unit quaternions, or None when not measured.
    """

    times: list[float]
    positions: list[list[float]]
    orientations: list[list[float]] | None


@dataclass(frozen=True)
class Version:
    """One saved version of a path; the curve is the `LearnedPath` with the same number.

    Attributes:
        path: id of the learned path.
        number: from 1, in the order of saving, over all branches of a path.
        parent: number of the version that was edited; None for the learned path.
        branch: line of versions that this version continues.
    """

    path: str
    number: int
    parent: int | None
    branch: str
    name: str
    author: str
    note: str
    created_ns: int
