"""Planning jobs: the joints that were shown are read here, and the plan is signed here, whoever plans."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from teachpath.io.store.recordings import Recordings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.signature import CalibrationScope, SigningKey, sign_plan
from teachpath.motion.settings import MotionSettings
from teachpath.recording.phases import TransportSpan
from teachpath.recording.posture import shown_joints
from teachpath.records import Demonstration, LearnedPath, Plan, Scene, ShownPosture, ToolOutput


@dataclass(frozen=True)
class StoredPosture:
    """A demonstration by an arm, whose joints are still to be read."""

    recordings: Recordings
    row: Demonstration

    def read(self) -> ShownPosture:
        """Return the joints that it showed; raises NotFound, UnusableRecording or StorageUnavailable."""
        row = self.row
        samples = self.recordings.columns(row.recording, row.digest)
        return ShownPosture(row.id, shown_joints(samples, TransportSpan(*row.transport), row.left_out))


def find_posture(store: Store, task: str, path: LearnedPath, arm: Arm) -> StoredPosture | None:
    """Return the most consistent demonstration of a path that an arm with as many joints showed; None without one."""
    clusters = store.run(path.run).learned.clusters if path.run else ()
    scores = [score for cluster in clusters if cluster.index == path.cluster for score in cluster.scores]
    ranks = {score.demonstration: score.rank for score in scores if score.selected}
    rows = [d for d in store.demonstrations(task) if d.id in ranks and d.statistics.joints == arm.joint_count]
    return StoredPosture(store.recordings, min(rows, key=lambda row: ranks[row.id])) if rows else None


@dataclass(frozen=True)
class Signer:
    """What a plan is signed with as soon as it is certified.

    Attributes:
        key: of the station.
        calibrations: of the demonstrations that the path was learned from.
        author: who had it planned, as the station knows it; empty: it does not ask.
    """

    key: SigningKey
    calibrations: CalibrationScope
    author: str = ""


PlanOrder = tuple[LearnedPath, Scene, MotionSettings, Arm, ShownPosture | None, ToolOutput | None]


def read_to_plan(
    path: LearnedPath,
    scene: Scene,
    settings: MotionSettings,
    arm: Arm,
    posture: StoredPosture | None,
    output: ToolOutput | None,
    signer: Signer,
) -> PlanOrder:
    """Return what a path is planned from; the key stays here."""
    del signer
    return path, scene, settings, arm, None if posture is None else posture.read(), output


def sign_planned(
    made: Plan,
    path: LearnedPath,
    scene: Scene,
    settings: MotionSettings,
    arm: Arm,
    posture: StoredPosture | None,
    output: ToolOutput | None,
    signer: Signer,
) -> Plan:
    """Sign a plan that was made of these."""
    del path, scene, posture, output
    ordered = replace(made, author=signer.author)
    return sign_plan(ordered, arm, settings, signer.key, issued_ns=time.time_ns(), calibrations=signer.calibrations)
