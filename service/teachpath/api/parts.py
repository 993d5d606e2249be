"""The running parts that the resources speak to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from teachpath.config import Settings
from teachpath.io.store.store import Store
from teachpath.jobs.curve_assessor import CurveAssessor
from teachpath.jobs.jobs import Jobs
from teachpath.recorder.calibrations import Calibrations
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.websocket_trackers import WebSocketTrackers
from teachpath.records import Demonstration, Trajectory
from teachpath.robot.executions import Executions
from teachpath.robot.joint_feed import JointFeed


@dataclass(frozen=True)
class Parts:
    """What a station consists of, for the resources."""

    settings: Settings
    store: Store
    recorder: Recorder
    calibrations: Calibrations
    jobs: Jobs
    assessor: CurveAssessor
    executions: Executions
    websocket_trackers: WebSocketTrackers
    joints: JointFeed
    trajectory: Callable[[Demonstration], Trajectory]
    health: Callable[[], dict[str, Any]]
    imported: Callable[[Demonstration, Trajectory], None]
