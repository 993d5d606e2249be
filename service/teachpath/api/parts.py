"""The running parts that the resources speak to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from teachpath.config import Settings
from teachpath.io.store.store import Store
from teachpath.records import Demonstration, Trajectory
from teachpath.workers.assessor import Assessor
from teachpath.workers.calibrations import Calibrations
from teachpath.workers.executions import Executions
from teachpath.workers.gate import TrackerGate
from teachpath.workers.jobs import Jobs
from teachpath.workers.joints import JointFeed
from teachpath.workers.recorder import Recorder


@dataclass(frozen=True)
class Parts:
    """What a station consists of, for the resources."""

    settings: Settings
    store: Store
    recorder: Recorder
    calibrations: Calibrations
    jobs: Jobs
    assessor: Assessor
    executions: Executions
    gate: TrackerGate
    joints: JointFeed
    trajectory: Callable[[Demonstration], Trajectory]
    health: Callable[[], dict[str, Any]]
    imported: Callable[[Demonstration, Trajectory], None]
