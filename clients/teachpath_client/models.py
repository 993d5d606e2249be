"""What a station answers: frozen records with the names and types of the REST API.

Generated from its description by `python -m tests.contract.openapi`; do not edit. Metres, radians, seconds; quaternions
w, x, y, z; times that end in `_ns` are nanoseconds since the Unix epoch.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Capability = Literal["view", "demonstrate", "teach", "operate", "administer"]

ExecutorState = Literal["idle", "starting", "approaching", "following", "held", "stopping", "ended", "faulted"]

FistCommand = Literal["toggle", "discard"]

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled"]

JournalVerb = Literal[
    "start",
    "override",
    "hold",
    "resume",
    "stop",
    "reverse",
    "step",
    "revoke",
    "teleoperate",
    "acknowledge",
    "acquire control",
    "release control",
    "ask control",
    "keep control",
    "unasked motion",
]

LimitSource = Literal["model", "operator", "default"]

Phase = Literal["reach", "grasp", "transport", "release", "return"]

ProcessState = Literal["running", "restarting", "ended"]

RecordingState = Literal["recording", "countdown", "pausing", "paused", "lost"]

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

    With the chord c from start a to goal b, its horizontal length D and direction y, and at shares u of the arc length,
    the course is a + u c + D^0.8 sum_i w_i (R(y - yaw_i) s_i + s_i) / 2 + closeness * own + similarity * edits. The
    weights w, and a multiplier, are `inverse` times the covariances of (D, y) with the demonstrations, and 1.

    Attributes:
        turns: False for closed or vertical paths, whose shapes s_i are added as they are, without D and R.
        shapes: of each demonstration (n, 3), in the axes of the world.
        chords: of each demonstration (3,) [m], with its D and y.
        length: of a typical demonstration [m].
        places: at how many different starts or goals they were shown.
        inverse: of the kriging system.
        variance: (n,) per unit of scale and of kriging variance; None after one demonstration.
        learned: (n, 3) [m] the path as it was learned.
        own: (n, 3) [m] what it has beside the prediction for its ends.
        version: (n, 3) [m] the version that is adapted.
        edits: (n, 3) [m] what it has beside the adapted learned path.
    """

    turns: bool
    shapes: list[list[list[float]]]
    chords: list[list[float]]
    length: float
    places: int
    inverse: list[list[float]]
    variance: list[float] | None
    learned: list[list[float]]
    own: list[list[float]]
    version: list[list[float]]
    edits: list[list[float]]


@dataclass(frozen=True)
class Advice:
    """What the operator of a task should do next, in words.

    Attributes:
        task: name of the task.
        sentence: what to do next.
    """

    task: str
    sentence: str


@dataclass(frozen=True)
class ArmSummary:
    """What a list says of an arm that is kept: its newest version, and its joints by name.

    Attributes:
        name: of the arm.
        version: its newest, from 1.
        hash: of the arm, as `SerialArm.hash`.
        file: name of the model's file.
        created_ns: when that version was kept [ns since the Unix epoch].
        joints: from the base to the tool.
        held: joints of the model that are no joints of the arm.
    """

    name: str
    version: int
    hash: str
    file: str
    created_ns: int
    joints: list[str]
    held: list[str]


@dataclass(frozen=True)
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

    lengths: list[float]
    parameters: list[float]
    positions: list[list[float]]
    faults: list[str | str]
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
class AuditEntry:
    """One entry of the audit log.

    Attributes:
        number: in the log, from 1.
        at_ns: when it was written [ns since the Unix epoch].
        who: did it, as the station knows it.
        source: address or place from which it came: an IP address, `executor`, `command line`.
        action: that was asked for.
        answer: how it was answered.
        previous: hash of the entry before.
        hash: of all that stands above (SHA-256, hex).
    """

    number: int
    at_ns: int
    who: str
    source: str
    action: str
    answer: str
    previous: str
    hash: str


@dataclass(frozen=True)
class BusSettings:
    """Where the Zenoh session of this process meets the others.

    Attributes:
        endpoint: the service or its router listens here, workers and clients connect here; across machines
            tls/HOST:PORT.
        mode: peer: the service listens; router: it listens and passes on between further routers, too; client:
            a router listens at the tls/ endpoint instead, configured by `teachpath station router`.
        config: file of Zenoh's own configuration (JSON5) for the service's session, for what the station does
            not set itself; empty: none.
        prefix: first segments of every key; one per station.
        robot: name of the arm in its keys.
        access_control: every role has its own login and its own keys; false lets every program that reaches the
            endpoint do everything.
        certificates: folder of the certificates for a tls/ endpoint, which `teachpath station certificates`
            makes.
        connect_timeout: [s] how long to wait for the endpoint when connecting.
    """

    endpoint: str = "tcp/127.0.0.1:7447"
    mode: str = "peer"
    config: str = ""
    prefix: str = "teachpath/station"
    robot: str = "puma560"
    access_control: bool = True
    certificates: str = "teachpath-certificates"
    connect_timeout: float = 10.0


@dataclass(frozen=True)
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
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Certificate:
    """The proof that the arm can follow a plan; uses are shares of the limits, at most 1.

    Attributes:
        digest: SHA-256 over plan, certificate and arm, without the plan's id, author and signature (hex).
        branch: of the arm on the whole path, in words, e.g. righty, elbow up.
        position_use: largest share of the joints' range.
        velocity_use: largest share of the joints' speed limits.
        acceleration_use: largest share of the joints' acceleration limits.
        jerk_use: largest share of the joints' jerk limits.
        torque_use: largest share of the motors' torque that any sequence of commands can ask for on the path.
        least_singular: least singular value of the Jacobian.
        clearance: least distance of arm and carried object to scene and self [m].
        tool_speed: the most of elbow, wrist and tool centre point on the path [m/s]; None: it was made before
            that was measured.
        signature: None: it was made outside a station, or before stations signed.
    """

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
        offset_ns: host clock minus device clock at the newest sample [ns]. It includes the minimum one-way
            transit time, which cannot be observed without a round trip.
        uncertainty_ns: median transit time minus the minimum [ns].
        rate: seconds of the device's clock in one second of the host's.
    """

    offset_ns: int
    uncertainty_ns: int
    rate: float


@dataclass(frozen=True)
class Cluster:
    """Demonstrations that do the task alike, with their scores.

    Attributes:
        index: its number in the run, from 1.
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
        lowest: least height of a cut that leaves that many [m].
        highest: greatest height of a cut that leaves that many [m]; None: no upper end.
        height: halfway between them [m].
        leaf_ranges: for each cluster, in the order of its number, the begin and end of its members in the
            dendrogram's `leaves`; the end is excluded.
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

    Attributes:
        id: of the demonstration.
        task: name of its task.
        number: 1, 2, ... within its task.
        source: name of the tracker or the file.
        calibration: under which it was recorded.
        created_ns: when it was made [ns since the Unix epoch].
        duration: of the transport phase [s].
        samples: in its recording.
        grasp: index of the first sample of the transport phase, by the recorder's own cut.
        release: index behind its last sample.
        verdict: clean, repaired (usable, with losses) or reject (not learned from).
        statistics: counts of its samples.
        recording: place of the MCAP file within the recordings, or its address in object storage (`s3://...`).
        reasons: why the verdict is not clean, with figures.
        advice: what the operator should know and do about it, in one sentence.
        left_out: numbers of the samples that jumped.
        trim: begin and end (excluded) of the transport phase by the operator's cut, as indices of samples;
            None: the recorder's holds.
        mark: the operator's own: good, bad or empty for none.
        discarded_ns: when it was discarded [ns since the Unix epoch]; 0: it is not.
        amended_by: who marked, trimmed, discarded or restored it last, where the station asks.
        digest: of its recording; None: it was stored before digests were.
        object_pose: of the object before it was grasped; None: as the scene has it.
        source_sha256: of the file that it was imported from, hexadecimal; empty: it was not imported.
        station: that it was made at; empty where a station has no name.
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
    amended_by: str = ""
    digest: RecordingDigest | None = None
    object_pose: ObjectPose | None = None
    source_sha256: str = ""
    station: str = ""


@dataclass(frozen=True)
class Dendrogram:
    """The dendrogram of a run, ready to be drawn.

    Attributes:
        demonstrations: ids in the order of their numbers in `merges`, 0 to m - 1.
        leaves: ids from left to right; no merge crosses another, and the members of every cluster are
            neighbours.
        merges: left, right, height [m] and number of members, as scipy writes them; merge i has the number m +
            i.
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
    """Where and how a demonstration deviates most from the others of its cluster.

    Attributes:
        share: begin and end as shares of the arc length, 0 to 1.
        seconds: begin and end since the first sample [s].
        sentence: both in words.
    """

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
    """A curve after an operation, and its largest distance [m] from the curve before, measured at 401 parameters.

    Attributes:
        curve: after the operation.
        deviation: its largest distance from the curve before, measured at 401 parameters [m].
    """

    curve: Curve
    deviation: float


@dataclass(frozen=True)
class Execution:
    """An execution as stored; `plan` is None when the arm followed a live hand.

    Attributes:
        id: of the execution.
        plan: id of the plan; None: the arm followed a live hand.
        created_ns: when it was ordered [ns since the Unix epoch].
        status: the newest of the executor.
        station: whose arm moved; empty where it has no name.
    """

    id: str
    plan: str | None
    created_ns: int
    status: ExecutorStatus
    station: str = ""


@dataclass(frozen=True)
class ExecutorStatus:
    """Where an execution stands; see teachpath/v1/motion.proto for the fields.

    Attributes:
        execution: id of the newest execution; empty: there was none.
        state: what it does: idle, approaching, following, held, stopping, ended or faulted.
        reason: why it is held, stopped or faulted, in words; empty otherwise.
        progress: share of the path's length, 0 to 1.
        override: share of the planned speed that is asked for, 0 to 1.
        cycles: control periods of the loop so far.
        late: cycles that woke later than half a period.
        missed: cycles left out because the one before took too long.
        lateness_p50_us: median lateness of a cycle [us].
        lateness_p99_us: 99th percentile of the lateness of a cycle [us].
        lateness_max_us: largest lateness of a cycle [us].
        limit_use: largest share of a joint limit used by the setpoints sent.
        tracking_error: farthest that the arm was off its setpoints, or by its own account off what it wanted
            [rad].
        limit_place: where limit_use was reached, in words.
        duration: from the first setpoint to the newest [s].
        length: how far along the path the tool is [m].
        activity: what the arm does, in words, e.g. on the path, closing the gripper.
        operator: who holds control; empty: nobody.
        asking: who asks for control; empty: nobody.
        scheduling: whether the loop runs before all other processes, in words.
        hand_latency_p50_us: with a live hand, median from a sample's coming to the setpoint that answers it
            [us].
        hand_latency_p99_us: with a live hand, 99th percentile of the same [us].
        ending: whether it is over as soon as the arm rests, because it was stopped or given up.
        unasked_motion: that the arm moves although nothing is under way, in words; nothing starts before
            somebody acknowledges it.
        hand: the tracker whose live hand is followed; empty: a plan is.
        hand_scene: the scene in which it is followed.
        hindrance: what keeps the tool from where the hand is, in words; empty: nothing.
        awaits_clutch: whether the arm rests until the clutch is pressed, and nothing else keeps it.
    """

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
    hand: str = ""
    hand_scene: str = ""
    hindrance: str = ""
    awaits_clutch: bool = False


@dataclass(frozen=True)
class Extreme:
    """A largest or least value on a path and where it occurs.

    Attributes:
        value: in the unit of what it is the extreme of.
        place: in words, e.g. joint 3 at s = 0.412 m.
        s: arc length from the start of the path [m].
    """

    value: float
    place: str
    s: float


@dataclass(frozen=True)
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
        fault: what is wrong with it, in words
    """

    place: str
    fault: str


@dataclass(frozen=True)
class FileReport:
    """What was understood of a file, and what would be made of it.

    Attributes:
        file: its name.
        format: name of its reader; empty: no reader could read it.
        understood: what was taken for time, units, orientation, phases and frame, one phrase each.
        columns: what the columns of a table are called; those without a name by their numbers from 1.
        choices: bodies, markers or topics of which one is read; empty: there is no choice.
        motions: how many there are in it.
        unsure: numbers of those of which it is not known where the object was taken and put, from 1.
        motion: number of the one that is shown.
        dwell_times: where its hand dwells, when that is not known [s].
        grasp: when its object is taken, from the beginning of the motion [s].
        release: likewise, when it is put [s].
        times: of its points, from its beginning [s].
        positions: of these points [m, world].
        made: demonstrations that would be made, with their verdicts.
        refusal: why it cannot be imported as it is, and the way out at the command line; empty: it can.
        question: what of it an answer would mend; null: it is another fault.
        sha256: of the file, hexadecimal.
        imported_before: that the task has demonstrations of the same file, in words; empty: it has none.
    """

    file: str
    format: str = ""
    understood: list[str] = field(default_factory=list)
    columns: list[str] = field(default_factory=list)
    choices: list[str] = field(default_factory=list)
    motions: int = 0
    unsure: list[int] = field(default_factory=list)
    motion: int = 1
    dwell_times: list[float] = field(default_factory=list)
    grasp: float | None = None
    release: float | None = None
    times: list[float] = field(default_factory=list)
    positions: list[tuple[float, float, float]] = field(default_factory=list)
    made: list[Demonstration] = field(default_factory=list)
    refusal: str = ""
    question: OpenQuestion | None = None
    sha256: str = ""
    imported_before: str = ""


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Health:
    """Which parts of a station run, and what an operator should know.

    Attributes:
        version: of the service.
        uptime: since the station was opened [s].
        bus: where the Zenoh session of the station meets the others.
        processes: of each process beside the service, whether it is `running`, `restarting` or has `ended`.
        recording: trackers that are being recorded.
        backlog: samples that wait for the recorder.
        longest_backlog: the most samples that have waited since the station was opened.
        trackers: that are there.
        guidance: what the operator should do next.
        executor: None until it has said something.
        notes: in words, what needs somebody.
        display_name: what people call the station; empty: nobody said.
    """

    version: str
    uptime: float
    bus: BusSettings
    processes: dict[str, ProcessState]
    recording: list[str]
    backlog: int
    longest_backlog: int
    trackers: list[Tracker]
    guidance: Advice
    executor: ExecutorStatus | None
    notes: list[str]
    display_name: str


@dataclass(frozen=True)
class Identity:
    """Who you are at a station.

    Attributes:
        mode: how it tells who asks; `none`: it does not ask.
        name: yours; empty where it does not ask.
        capabilities: what you may do.
        provider: at which people sign in; empty: with a password.
        groups: yours, as the proxy tells them where `mode` is `proxy`.
    """

    mode: str
    name: str
    capabilities: list[Capability]
    provider: str = ""
    groups: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Job:
    """Background work on a task: `learn`, `recut`, `plan` or `import`.

    Attributes:
        id: of the job.
        task: name of the task.
        kind: what it does.
        request: what was ordered, as its kind takes it.
        state: where it stands.
        fraction: of the work that is done, 0 to 1.
        message: what it does now, or why it failed.
        outcome: id of the run or plan that it made; of an import the numbers of the first and the last
            demonstration, e.g. `3-5`.
        attempt: how often it was begun; a restart of the service begins it anew.
        created_ns: when it was queued [ns since the Unix epoch].
        finished_ns: when it ended [ns since the Unix epoch]; 0: it has not.
        failure: where a path fails that the arm cannot follow, why, and what to change.
        demonstration: id of the one because of which nothing could be learned.
        who: ordered it, where the station asks.
        station: that it was ordered at.
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
    who: str = ""
    station: str = ""


@dataclass(frozen=True)
class JointGeometry:
    """How a joint moves its link: about an axis through a point, both in the link's own frame.

    Attributes:
        name: of the joint.
        position: of the link's frame in that of the link before, the world for the first, while the joint is at
            0 [m].
        orientation: likewise, unit quaternion w, x, y, z.
        axis: unit vector about which the link turns.
        anchor: a point on the axis [m].
    """

    name: str
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    axis: tuple[float, float, float]
    anchor: tuple[float, float, float]


@dataclass(frozen=True)
class JointLimit:
    """A limit of a joint, and who says so.

    Attributes:
        value: in the unit of what it limits [rad, rad/s, rad/s^2, rad/s^3 or N m].
        source: who says so.
    """

    value: float
    source: LimitSource


@dataclass(frozen=True)
class JournalEntry:
    """Who did what to the arm, and how that was answered.

    Attributes:
        at_ns: when it was answered [ns since the Unix epoch].
        who: gave the command.
        verb: what was commanded, or what happened by itself.
        execution: id of the execution; empty: none was meant.
        answer: done, or why it was refused or happened.
    """

    at_ns: int
    who: str
    verb: JournalVerb
    execution: str
    answer: str


@dataclass(frozen=True)
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
        id: of the path.
        run: id of the learning run.
        cluster: number of the cluster in the run.
        version: see `Version`; the learned path itself is version 1.
        curve: positions of the object's centre [m, world].
        fit: None for an edited version, which follows no demonstrations.
        note: what one should know of the fit, in words; empty: nothing.
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
    """Who is in control; `token` is told only to whom it belongs.

    Attributes:
        holder: who is in control; empty: nobody, everybody may command.
        expires_in: until it lapses without a beat [s].
        hold_when_lost: whether a moving arm is held when the beats stop.
        asking: who asks for control; empty: nobody.
        granted_in: until the one who asks gets it, unless the holder keeps it [s].
        token: for the header Teachpath-Lease; empty for all but the one who acquired or asked.
    """

    holder: str = ""
    expires_in: float = 0.0
    hold_when_lost: bool = False
    asking: str = ""
    granted_in: float = 0.0
    token: str = ""


@dataclass(frozen=True)
class LinkGeometry:
    """A link by its standard Denavit-Hartenberg parameters: a and d [m], alpha [rad].

    Attributes:
        a: length of the link along its x [m].
        d: offset along z of the link before [m].
        alpha: twist about its x [rad].
    """

    a: float
    d: float
    alpha: float


@dataclass(frozen=True)
class ListedPerson:
    """Somebody who may sign in, without the password.

    Attributes:
        name: of the person.
        roles: what the person may do.
        created_ns: when the person was added [ns since the Unix epoch].
        changed_ns: when the password was set [ns since the Unix epoch].
        sessions: that have not ended.
        used_ns: when something was asked in one of them last [ns since the Unix epoch]; 0: there is none.
    """

    name: str
    roles: list[Capability]
    created_ns: int
    changed_ns: int
    sessions: int
    used_ns: int


@dataclass(frozen=True)
class ListedToken:
    """A token, without itself; times in nanoseconds since the Unix epoch, 0: never.

    Attributes:
        name: of the program.
        roles: what it may do.
        created_ns: when it was made [ns since the Unix epoch].
        expires_ns: from when on it holds no longer [ns since the Unix epoch].
        used_ns: when it was last used, to the minute [ns since the Unix epoch]; 0: never.
        revoked_ns: when it was revoked [ns since the Unix epoch]; 0: it was not.
    """

    name: str
    roles: list[Capability]
    created_ns: int
    expires_ns: int
    used_ns: int
    revoked_ns: int


@dataclass(frozen=True)
class MadeToken:
    """A token that was just made; it is told this once.

    Attributes:
        token: for the header Authorization, as `Bearer TOKEN`.
        name: of the program.
        roles: what it may do.
        expires_ns: from when on it holds no longer [ns since the Unix epoch].
    """

    token: str
    name: str
    roles: list[Capability]
    expires_ns: int


@dataclass(frozen=True)
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
    points: list[TaughtPoint] = field(default_factory=list)
    rms: float = 0.0
    source: str = ""
    created_ns: int = 0
    author: str = ""


@dataclass(frozen=True)
class MeshHull:
    """The convex hull or pieces of a mesh, as a shape of a scene takes them.

    Attributes:
        file: its name
        vertices: three corners a triangle, counter-clockwise from outside, in its units
        max_pieces: most pieces that were asked for
        pieces: number of triangles of each convex piece; none: it is one hull
    """

    file: str
    vertices: list[tuple[float, float, float]]
    max_pieces: int = 1
    pieces: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class MotionPreview:
    """The motion at full speed from the arm's home, at even instants.

    Attributes:
        plan: id of the plan.
        times: (n,) [s], from 0.
        joints: (n, joints) configurations [rad].
        progress: (n,) share of the learned path's length that is done.
        gripper_closed: (n,) whether the gripper is closed.
        object_position: (n, 3) centre of the carried object [m, world]; (0, 3) when the scene has none.
        object_orientation: (n, 4) to world from object, quaternion w, x, y, z; (0, 4) when the scene has none.
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
    """Where the object of a scene lies: its centre [m, world], and its orientation w, x, y, z.

    Attributes:
        position: of its centre [m, world].
        orientation: to world from object, unit quaternion w, x, y, z.
    """

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class OpenQuestion:
    """What a file leaves open; the command line and the page each say in their words where to answer it.

    Attributes:
        problem: what is open, or wrong as it was read.
        option: that answers it.
        values: of the option that may be right; empty: any.
    """

    problem: str
    option: str
    values: list[str] = field(default_factory=list)


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Plan:
    """Path plus timing plus certificate: all that the executor needs.

    Attributes:
        id: of the plan.
        path: id of the learned path.
        path_version: number of the path's version.
        scene: that it was checked against.
        lengths: (n,) arc length of the nodes [m], from 0, strictly increasing.
        joints: (n, joints) configurations at the nodes [rad]; between them a quintic spline runs, on even
            parameters from 0 to 1.
        squared_rates: (m,) coefficients of the square of the parameter's rate at full speed, a quadratic spline
            on even intervals [1/s^2].
        limits: (3, joints) of the joints' speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] while they
            follow the path, at any override.
        above_start: (joints,) configuration above the start, from where the object is grasped.
        above_goal: (joints,) configuration above the goal, to where the arm retreats.
        duration: of the path at full speed [s].
        certificate: the proof that the arm can follow it.
        tool_speed: limit of elbow, wrist and tool centre point [m/s], at any override; None: no limit.
        posture: how near it keeps to the joints that were shown; None: no arm showed it, or they were not to
            count.
        output: of the arm that is on while the tool follows the path; None: none is.
        author: who had it planned, where the station asks; empty: not said.
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
    posture: Posture | None
    output: ToolOutput | None
    author: str


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Posture:
    """How near a plan keeps to the joints that a demonstration showed.

    Attributes:
        demonstration: its id.
        distance: of the joint that is farthest from what was shown, at the same share of the way's length
            [rad].
    """

    demonstration: str
    distance: Extreme


@dataclass(frozen=True)
class Probe:
    """That the service lives, or is ready.

    Attributes:
        version: of the service.
    """

    version: str


@dataclass(frozen=True)
class ReaderName:
    """A reader of recordings.

    Attributes:
        name: as `format` takes it
        title: what it reads
    """

    name: str
    title: str


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
        task: name of the task.
        tracker: name of the tracker.
        demonstrations: ids of those made so far, in order.
        received: samples that came.
        lost: numbers that never came.
        duplicated: samples that came again.
        reordered: samples that came after newer ones.
        late: samples that came after the demonstration they belong to was cut, which is made without them.
        refused: samples that could not be used.
        untracked: samples in which the tracker did not see the hand.
        gaps: stretches of numbers that never came.
        missing: first and last of the numbers that never came, of the first 20 gaps.
        longest_gap_ns: longest time without a sample, device clock [ns].
        conflicts: samples whose number was taken, or contradicts their device time.
        clock_jumps: times that the device's clock jumped.
        declared_rate: [Hz] that the client said; 0: none.
        seen_rate: [Hz] numbers a second of the device's clock.
        clock_offset_ns: host clock minus device clock, with the least transit in it [ns].
        clock_uncertainty_ns: median transit time minus the least [ns].
        clock_rate: seconds of the device's clock in one of the host's; 0: not known.
        idle: samples that belong to no demonstration.
        phase: of the hand; empty when the recording has ended.
        state: what becomes of the samples; empty when the recording has ended.
        pedal_used: whether the pedal has been pressed in this recording.
        countdown_left: [s] until samples are recorded.
        takes_left: demonstrations until it pauses by itself; 0: nobody has said how many.
        pending_command: what the fist that is held now commands when it opens; empty: nothing.
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
    phase: Phase | str
    state: RecordingState | str
    pedal_used: bool
    countdown_left: float
    takes_left: int
    pending_command: FistCommand | str
    notes: list[str]


@dataclass(frozen=True)
class Refusal:
    """Why a request was refused: problem details after RFC 9457.

    Attributes:
        type: the kind of the error as a URI; about:blank where there is no more to say than the status
        title: the kind of the error in words, always the same
        status: of HTTP
        detail: a sentence for the operator: value, limit, place, way out
        error: kind of the error, a word for programs
        errors: the unusable fields of the request, at most 20, when that is the reason
        newer: the version saved meanwhile, when that is the reason
        failure: where the path fails, why, and which control point to move
        demonstration: id of the demonstration that is to blame
    """

    type: str
    title: str
    status: int
    detail: str
    error: str
    errors: list[Fault] = field(default_factory=list)
    newer: Version | None = None
    failure: Failure | None = None
    demonstration: str = ""


@dataclass(frozen=True)
class RevoluteJoint:
    """A joint that turns its link against the link before.

    Attributes:
        name: in the model.
        anchor: a point on the axis, in the frame of the joint's own link [m].
        axis: unit vector, in the same frame.
        lower: least angle [rad].
        upper: largest angle [rad].
        speed: [rad/s].
        acceleration: [rad/s^2].
        jerk: [rad/s^3].
        torque: of the motor, at the joint [N m].
        armature: inertia of the motor, at the joint [kg m^2].
        damping: viscous friction at the joint [N m s].
        friction: Coulomb friction at the joint [N m].
    """

    name: str
    anchor: tuple[float, float, float]
    axis: tuple[float, float, float]
    lower: JointLimit
    upper: JointLimit
    speed: JointLimit
    acceleration: JointLimit
    jerk: JointLimit
    torque: JointLimit
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Robot:
    """How the arm is built.

    Attributes:
        name: of the arm in its keys.
        variant: the published table that its lengths and masses come from; of an arm that was added, its name.
        model: SHA-256 of an arm that was added (hex); empty for a published one.
        links: of a published arm, from the base to the wrist; empty for one that was added.
        joints: from the base to the flange.
        lower: (joints,) limits of the joints [rad].
        upper: (joints,) likewise.
        speed: (joints,) limits [rad/s].
        acceleration: (joints,) limits [rad/s^2].
        jerk: (joints,) limits [rad/s^3].
        torque: (joints,) limits [N m].
        tool: its pose to the flange.
        tool_length: from where the gripper sits to the tool centre point [m]; 0: there is no gripper.
        finger_travel: of each finger [m].
        home: configuration in which the arm waits [rad].
        tool_speed: limit of elbow, wrist and tool centre point [m/s]; None: no limit.
        payload_mass: of what the flange carries besides the gripper and the scene's object [kg].
        payload_center: its centre of mass in the flange's frame [m].
    """

    name: str
    variant: str
    model: str
    links: list[LinkGeometry]
    joints: list[JointGeometry]
    lower: list[float]
    upper: list[float]
    speed: list[float]
    acceleration: list[float]
    jerk: list[float]
    torque: list[float]
    tool: ToolPose
    tool_length: float
    finger_travel: float
    home: list[float]
    tool_speed: float | None
    payload_mass: float
    payload_center: list[float]


@dataclass(frozen=True)
class Run:
    """A learning run as stored.

    Attributes:
        id: of the run.
        task: name of the task.
        created_ns: when it was made [ns since the Unix epoch].
        learned: its result.
    """

    id: str
    task: str
    created_ns: int
    learned: Learned


@dataclass(frozen=True)
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
    mode: str
    demonstrations: int
    paths: list[str]


@dataclass(frozen=True)
class SavedScene:
    """A version of a scene, and the scene itself.

    Attributes:
        version: who saved it, and when.
        scene: as it is in this version.
    """

    version: SceneVersion
    scene: Scene


@dataclass(frozen=True)
class SavedVersion:
    """A version of a learned path, and the path itself.

    Attributes:
        version: who saved what, and from which one.
        path: the learned path as it is in this version.
    """

    version: Version
    path: LearnedPath


@dataclass(frozen=True)
class Scene:
    """What stands around the arm. Obstacles include the table; `carried` is the object at its start, or None.

    Arm, gripper and carried object stay above the floor, inside every box of `keep_in` and out of every shape of
    `keep_out`; nothing stands in these zones, they are rules.

    Attributes:
        name: of the scene.
        obstacles: what stands there, the table among it.
        carried: the object where it lies; None: the scene has none.
        floor: height of the floor [m, world]; the arm's foot stands at 0.
        keep_in: boxes that arm, gripper and carried object stay inside.
        keep_out: shapes of any kind that they stay out of.
        display_name: what people call it; empty: its name. Plans hold whatever it is called, and have it empty.
    """

    name: str
    obstacles: list[Shape] = field(default_factory=list)
    carried: Shape | None = None
    floor: float = 0.0
    keep_in: list[Shape] = field(default_factory=list)
    keep_out: list[Shape] = field(default_factory=list)
    display_name: str = ""


@dataclass(frozen=True)
class SceneVersion:
    """Who changed a scene, and when.

    Attributes:
        scene: its name.
        number: from 1, in the order of saving; a scene of the settings is the first one.
        created_ns: when it was saved [ns since the Unix epoch]; 0: it stands in the settings, and was never
            changed.
        author: who changed it; empty: not said.
        note: why; empty: not said.
        removed: the scene was removed with this version, which holds it as it was last.
    """

    scene: str
    number: int
    created_ns: int
    author: str = ""
    note: str = ""
    removed: bool = False


@dataclass(frozen=True)
class Score:
    """The score of one demonstration in the selection of its cluster.

    Attributes:
        demonstration: its id.
        log_likelihood: of its observations under the models that score it.
        rank: 1 = most consistent.
        selected: whether the path is fitted to it.
        note: why it was not selected, or not scored.
        margin: distance to the next in rank, in robust z in mode default, else in log-likelihood; None for the
            last.
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
    """When a stretch of the motion lasts, in words and seconds.

    Attributes:
        name: what the arm does, in words.
        begin: from the start of the motion [s].
        end: from the start of the motion [s].
    """

    name: str
    begin: float
    end: float


@dataclass(frozen=True)
class SerialArm:
    """An arm of six or seven revolute joints, as a user's model describes it.

    Attributes:
        name: under which it is kept.
        links: from the base to the tool.
        tool: its pose to the last link; z points out of the tool.
        base: pose of the model to the world.
        base_solids: that do not move, in the model's frame.
        payload_mass: of what the tool carries besides the scene's object [kg].
        payload_center: its centre of mass in the tool's frame [m].
        held: joints of the model that are no joints of the arm (such as fingers); they rest where the model has
            them.
        gripper_length: from where teachpath's own gripper sits to the tool, along the tool's z [m]; 0: there is
            none.
    """

    name: str
    links: list[SerialLink]
    tool: tuple[tuple[float, float, float], tuple[float, float, float, float]]
    base: tuple[tuple[float, float, float], tuple[float, float, float, float]]
    base_solids: list[Shape] = field(default_factory=list)
    payload_mass: float = 0.0
    payload_center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    held: list[str] = field(default_factory=list)
    gripper_length: float = 0.0


@dataclass(frozen=True)
class SerialLink:
    """A link, with all that is fixed to it.

    Attributes:
        name: in the model.
        pose: to the frame of the link before from that of this link, while the joint is at zero.
        joint: that moves the link.
        mass: [kg].
        center: of mass, in the link's frame [m].
        inertia: moments xx, yy, zz and products xy, xz, yz about the centre of mass, along the link's axes [kg
            m^2].
        solids: that may collide, in the link's frame.
    """

    name: str
    pose: tuple[tuple[float, float, float], tuple[float, float, float, float]]
    joint: RevoluteJoint
    mass: float
    center: tuple[float, float, float]
    inertia: list[float]
    solids: list[Shape]


@dataclass(frozen=True)
class Shape:
    """One body of a scene.

    Attributes:
        name: of the shape within its scene.
        kind: `box` (size: full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius)
            or `mesh` (factor from its units to metres).
        size: what its kind says [m].
        position: of its centre, of a mesh its origin [m, world].
        color: RGB in 24 bits, 0xRRGGBB.
        orientation: to world from shape, unit quaternion w, x, y, z.
        file: OBJ, STL, PLY or GLB file of a mesh, beside the settings.
        vertices: of the mesh's convex hull or pieces, which take its place: three a triangle, in the file's
            units.
        mass: of the carried object [kg]; None: that of its volume at 300 kg/m^3, as a light wooden block has.
            Obstacles and zones have none.
        max_pieces: most convex pieces that a mesh is cut into when its file is read; 1: its hull.
        pieces: number of triangles of each convex piece of a mesh, in the order of `vertices`; empty: it is one
            hull.
    """

    name: str
    kind: str
    size: list[float]
    position: tuple[float, float, float]
    color: int = 8425632
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    file: str = ""
    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    mass: float | None = None
    max_pieces: int = 1
    pieces: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class SignInAddress:
    """Where a person signs in.

    Attributes:
        address: of the provider, with what it needs to know.
    """

    address: str


@dataclass(frozen=True)
class Signature:
    """What a station says with its key of a plan: that it made the plan, and what the certificate holds for.

    Attributes:
        arm: name of the published variant; of an arm that was added, its name and the begin of its hash.
        tool_length: from where the gripper sits to the tool centre point [m].
        settings: `motion` settings with which the plan was made.
        calibrations: of the demonstrations that the path was learned from.
        present_calibrations: the newest versions of these when the plan was made.
        issued_ns: when the plan was made [ns since the Unix epoch].
        expires_ns: when the certificate holds no longer [ns since the Unix epoch].
        mac: HMAC-SHA256 (hex) over the whole plan and the arm, by the station's signing key.
        tool: its pose to the flange; None: it lies on the axis of joint 6, `tool_length` ahead of the flange.
    """

    arm: str
    tool_length: float
    settings: dict[str, Any]
    calibrations: list[Calibration]
    present_calibrations: list[Calibration]
    issued_ns: int
    expires_ns: int
    mac: str
    tool: ToolPose | None = None


@dataclass(frozen=True)
class StoredArm:
    """One version of an arm as it is kept.

    Attributes:
        arm: itself.
        hash: of the arm, as `SerialArm.hash`.
        file: name of the model's file.
        version: of this name, from 1.
        created_ns: when it was kept [ns since the Unix epoch].
    """

    arm: SerialArm
    hash: str
    file: str
    version: int = 0
    created_ns: int = 0


@dataclass(frozen=True)
class StreamStatistics:
    """Counts of the samples of one recording or demonstration.

    All from `outliers` to `measured_rate` are of the transport phase only. Numbers that were sent are received, less
    the duplicated and conflicting, or lost, or refused.

    Attributes:
        received: samples that came.
        lost: numbers that never came.
        duplicated: samples that came again.
        reordered: came after newer ones, and were put in their place.
        late: came after the demonstration they belong to was cut, which is made without them.
        refused: samples that could not be used.
        refused_numbers: first and last of the refused numbers in a row, where they can be read.
        untracked: samples in which the tracker did not see the hand.
        gaps: stretches of numbers that never came.
        missing: first and last number of each of them, of the first 20.
        longest_gap_ns: longest time without a sample, device clock [ns].
        outliers: positions that their neighbours contradict; left out of the trajectory.
        level_shifts: places where the position jumps and stays.
        out_of_workspace: positions where no hand can be.
        reversals: samples between which no hand could swing back and forth.
        repeated: readings that repeat the one before while the hand moves; left out of the trajectory.
        longest_freeze_ns: longest time for which one of them stood, device clock [ns].
        freeze_at_ns: when that began, since the grasp [ns].
        measured_rate: readings a second that differ [Hz], where some repeat; 0: none does.
        conflicts: came with a number that was taken, or that their device time contradicts.
        flaps: times for which the glove read open or closed too shortly for a hand, from the grasp on.
        flap_at_ns: when the first of them was, since the grasp [ns].
        regrasp_ns: how long the hand was open when it had let go, if it closed again at once [ns]; 0: it did
            not.
        clock_jumps: times that the device's clock jumped.
        declared_rate: samples a second that the client declared [Hz]; 0: it said none.
        seen_rate: numbers a second of the device's clock [Hz].
        clock: of the device against the host's; None: not known.
        notes: what an operator should know, in words.
        dwell_times: where a hand without a glove dwells, if taking and putting are not sure [s].
        joints: how many joints the arm has that showed it; 0: a hand did.
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
    joints: int = 0


@dataclass(frozen=True)
class Suggestion:
    """What to change on a path: a control point (from 0), the move proposed for it [m], and both in a sentence.

    Attributes:
        control_point: its number, from 0.
        move: proposed for it [m, world].
        sentence: both in words.
    """

    control_point: int
    move: tuple[float, float, float]
    sentence: str


@dataclass(frozen=True)
class Task:
    """What is demonstrated: its name, its scene and the calibration of its demonstrations.

    Attributes:
        name: of the task, which is in its addresses.
        scene: name of what stands around the arm.
        calibration: name of the mapping to the world from the tracker's frame.
        created_ns: when it was made [ns since the Unix epoch].
        object_at_grasp: whether the object lies where the hand grasps, anew in each demonstration, instead of
            where the scene has it.
        archived_ns: when it was deleted [ns since the Unix epoch]; 0: it was not. All of it is kept, and can be
            brought back.
        display_name: what people call it; empty: its name.
    """

    name: str
    scene: str
    calibration: str
    created_ns: int
    object_at_grasp: bool = False
    archived_ns: int = 0
    display_name: str = ""


@dataclass(frozen=True)
class TaughtPoint:
    """One place that was shown to a tracker [m], and how far the mapping puts it from where it is [m].

    Attributes:
        tracker: where the tracker saw the place, in its frame and units.
        world: where the place is [m, world].
        residual: distance between the place and where the mapping puts it [m].
    """

    tracker: tuple[float, float, float]
    world: tuple[float, float, float]
    residual: float = 0.0


@dataclass(frozen=True)
class TimeSeries:
    """A recorded motion over time.

    Attributes:
        times: (n,) since the first setpoint [s].
        positions: (n, joints) of the joints [rad].
        velocities: (n, joints), each the one of largest magnitude since the time before [rad/s].
        torques: (n, joints), likewise [N m].
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
class ToolOutput:
    """An output of the arm that is on while the tool follows the path, e.g. of a nozzle, a spray gun or a torch.

    Attributes:
        name: of the output, as the arm's driver knows it.
        start: for which the arm rests at the start of the path with it on [s].
        end: for which the arm rests at the end of the path with it on [s].
    """

    name: str
    start: float = 0.0
    end: float = 0.0


@dataclass(frozen=True)
class ToolPose:
    """Pose of the tool to the flange: its centre point [m] and orientation; z points out of the gripper.

    Attributes:
        position: of the tool centre point [m, flange].
        orientation: to flange from tool, unit quaternion w, x, y, z; z points out of the gripper.
    """

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]


@dataclass(frozen=True)
class Touch:
    """A place at which a tracker was held still.

    Attributes:
        tracker: its name.
        position: mean of the readings, in the tracker's frame [m].
        deviation: of the reading farthest from it [m].
        readings: how many there were.
    """

    tracker: str
    position: tuple[float, float, float]
    deviation: float
    readings: int


@dataclass(frozen=True)
class Tracker:
    """A tracker that is there.

    Attributes:
        name: of the tracker in its keys.
        announced: whether by a liveliness token; a tracker without one only sends.
        silence: since its last sample [s]; negative: it has sent none.
    """

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
class Upload:
    """A file that was sent and waits to be imported, for a day or until the service ends.

    Attributes:
        id: by which it is examined and imported
        name: of the file
        size: bytes
    """

    id: str
    name: str
    size: int


@dataclass(frozen=True)
class Version:
    """One saved version of a path; the curve is the `LearnedPath` with the same number.

    Attributes:
        path: id of the learned path.
        number: from 1, in the order of saving, over all branches of a path.
        parent: number of the version that was edited; None for the learned path.
        branch: line of versions that this version continues.
        name: what somebody called it; empty: nothing.
        author: who edited it; empty: not said.
        note: why, or how it was made; empty: not said.
        created_ns: when it was saved [ns since the Unix epoch].
    """

    path: str
    number: int
    parent: int | None
    branch: str
    name: str
    author: str
    note: str
    created_ns: int
