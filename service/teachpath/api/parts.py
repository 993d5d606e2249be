"""The running parts of a station, as the resources use them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from teachpath.access.access import Access
from teachpath.access.audit import Audit
from teachpath.config import Settings
from teachpath.io.bus_settings import BusSettings
from teachpath.io.store.store import Store
from teachpath.jobs.curve_assessor import CurveAssessor
from teachpath.jobs.jobs import Jobs
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.offline.exporter import Exporter
from teachpath.offline.transfer_folders import TransferFolders
from teachpath.recorder.calibrations import Calibrations
from teachpath.recorder.presence import Tracker
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.websocket_trackers import WebSocketTrackers
from teachpath.records import ExecutorStatus
from teachpath.robot.executions import Executions
from teachpath.robot.joint_feed import JointFeed
from teachpath.robot.object_poses import ObjectPoses
from teachpath.robot.processes import ProcessState
from teachpath.robot.programs import Programs
from teachpath.robot.scenes import Scenes
from teachpath.web.certificate import WebCertificate

MAX_READERS: Final = 4  # threads of a resource that wait for recordings to be read


@dataclass(frozen=True, slots=True)
class Advice:
    """What the operator of a task should do next, in words.

    Attributes:
        task: name of the task.
        sentence: what to do next.
    """

    task: str
    sentence: str


@dataclass(frozen=True, slots=True)
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
    recording: tuple[str, ...]
    backlog: int
    longest_backlog: int
    trackers: tuple[Tracker, ...]
    guidance: Advice
    executor: ExecutorStatus | None
    notes: tuple[str, ...]
    display_name: str


@dataclass(frozen=True)
class Parts:
    """The parts of a station that the resources use."""

    settings: Settings
    access: Access
    audit: Audit
    certificate: WebCertificate | None
    store: Store
    recorder: Recorder
    calibrations: Calibrations
    jobs: Jobs
    assessor: CurveAssessor
    executions: Executions
    programs: Programs
    websocket_trackers: WebSocketTrackers
    joints: JointFeed
    scenes: Scenes
    objects: ObjectPoses
    reader: LimitedProcess
    mesh_reader: LimitedProcess
    health: Callable[[], Health]
    transfers: TransferFolders
    exporter: Exporter
    leave_task: Callable[[str], None]
