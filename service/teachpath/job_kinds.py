"""The kinds of jobs: what each reads from the store, which function does the work, and where its outcome goes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from teachpath.config import Settings
from teachpath.errors import NotFound
from teachpath.io.documents import from_document
from teachpath.io.store.recordings import RECORDINGS
from teachpath.io.store.store import Store
from teachpath.jobs import worker
from teachpath.jobs.executors import Work
from teachpath.jobs.jobs import JobKind
from teachpath.learning.settings import LearningSettings
from teachpath.motion.planning.signature import CalibrationScope, SigningKey
from teachpath.offline.import_job import PREPARED_FOLDER, ImportOrder, ImportRequest, PreparedImport, prepare_imports
from teachpath.offline.import_target import import_calibration, import_scene, starts_at_object
from teachpath.offline.learning_job import (
    StoredDemonstrations,
    learn_read,
    read_to_learn,
    read_to_recut,
    recut_read,
)
from teachpath.offline.planning_job import Signer, find_posture, read_to_plan, sign_planned
from teachpath.offline.transfer_folders import TransferFolders
from teachpath.recorder.calibrations import Calibrations
from teachpath.records import Demonstration, Job, Learned, LearnedPath, ObjectPose, Plan, Scene, Task, ToolOutput
from teachpath.robot.object_poses import ObjectPoses
from teachpath.robot.scenes import Scenes

PLANNING = Work(worker.plan_path, read_to_plan, sign_planned)


@dataclass(frozen=True)
class LearningKinds:
    """What jobs read and store that learn: nothing but store, recordings and settings.

    Attributes:
        store: of demonstrations and runs.
        settings: of the station.
        calibrations: that demonstrations have to be recorded under, in their present version.
        scenes: of the tasks.
        is_away: whether recordings that wait to be uploaded may lie on another machine, so that jobs wait for them.
    """

    store: Store
    settings: Settings
    calibrations: Calibrations
    scenes: Scenes
    is_away: bool = False

    def by_name(self) -> dict[str, JobKind]:
        """Return these kinds of jobs by the names that REST gives them."""
        return {
            "learn": JobKind(self._learning_input, Work(learn_read, read_to_learn), self._store_run),
            "recut": JobKind(self._recut_input, Work(recut_read, read_to_recut), self._store_run),
        }

    def _learning_input(self, job: Job) -> tuple[StoredDemonstrations, LearningSettings]:
        demonstrations = [d for d in self.store.demonstrations(job.task) if d.is_usable]
        if not demonstrations:
            raise NotFound(f"task {job.task} has no usable demonstrations yet; show it a few times first")
        if job.request.get("calibrations") != "recorded":
            self.calibrations.require_current(demonstrations)
        wanted = job.request.get("settings")
        settings = self.settings.learning_with(wanted if isinstance(wanted, dict) else {})
        return self._stored(job.task, demonstrations), settings

    def _recut_input(self, job: Job) -> tuple[Any, ...]:
        learned = self.store.run(str(job.request["run"])).learned
        usable = {d.id: d for d in self.store.demonstrations(job.task) if d.is_usable}
        chosen = {key: usable[key] for key in learned.demonstrations if key in usable}
        if job.request.get("calibrations") != "recorded":
            self.calibrations.require_current(list(chosen.values()), command="recut")
        return learned, self._stored(job.task, list(chosen.values())), job.request["threshold"], job.request["clusters"]

    def _stored(self, task: str, rows: list[Demonstration]) -> StoredDemonstrations:
        self.store.services.require_recorded_here(task)
        if self.is_away:
            self.store.recordings.require_uploaded([row.recording for row in rows])
        carried = self.scenes.get(self.store.task(task).scene).carried
        return StoredDemonstrations(
            self.store.recordings,
            tuple(rows),
            ObjectPose(carried.position, carried.orientation) if carried else None,
        )

    def _store_run(self, job: Job, learned: Learned) -> str:
        return self.store.finish_learning(job.id, learned)


@dataclass(frozen=True)
class JobKinds:
    """What jobs read and store.

    Attributes:
        store: of demonstrations, runs, paths and plans.
        settings: of the station.
        calibrations: that demonstrations have to be recorded under, in their present version.
        transfers: folders of uploaded files.
        imported: called with the name of a task that an import has added to.
        signing_key: with which plans are signed.
        scenes: of the tasks.
        objects: where the objects lie that paths are planned for.
    """

    store: Store
    settings: Settings
    calibrations: Calibrations
    transfers: TransferFolders
    imported: Callable[[str], None]
    signing_key: SigningKey
    scenes: Scenes
    objects: ObjectPoses

    def by_name(self) -> dict[str, JobKind]:
        """Return the kinds of jobs by the names that REST gives them."""
        return {
            **LearningKinds(self.store, self.settings, self.calibrations, self.scenes).by_name(),
            "plan": JobKind(self._planning_input, PLANNING, self._store_plan),
            "import": JobKind(
                self._import_input,
                Work(prepare_imports),
                self._store_import,
                lane="files",
                clean_up=self._remove_uploads,
            ),
        }

    def _planning_input(self, job: Job) -> tuple[Any, ...]:
        path, version = str(job.request["path"]), job.request.get("version")
        learned = self.store.versions.get(path, version)[1] if isinstance(version, int) else self.store.path(path)
        scene = self.objects.scene_for(self.store.task(job.task).scene, learned)
        signer = Signer(self.signing_key, self._calibrations_of(job.task, learned), job.who)
        arm, free = self.settings.arm, job.request.get("posture") == "free"
        posture = None if free else find_posture(self.store, job.task, learned, arm)
        given = job.request.get("output")
        output = from_document(ToolOutput, given) if isinstance(given, dict) else None
        return learned, scene, self.settings.motion, arm, posture, output, signer

    def _calibrations_of(self, task: str, path: LearnedPath) -> CalibrationScope:
        """Return the calibrations, each once, of the demonstrations that a path was learned from."""
        clusters = self.store.run(path.run).learned.clusters if path.run else ()
        members = {member for cluster in clusters if cluster.index == path.cluster for member in cluster.members}
        used = dict.fromkeys(d.calibration for d in self.store.demonstrations(task) if d.id in members)
        recorded = tuple(map(self.calibrations.numbered, used))
        return CalibrationScope(recorded, tuple(map(self.calibrations.newest_numbered, recorded)))

    def _import_input(self, job: Job) -> tuple[tuple[ImportOrder, ...]]:
        given = from_document(ImportRequest, job.request)
        scene = self._scene_of(job.task, given)
        at_grasp = starts_at_object(self.store, job.task, given.object_at_grasp)
        return (
            tuple(
                ImportOrder(
                    key=f"{job.id} {number}",
                    folder=self.transfers.folder(file.upload),
                    task=job.task,
                    name=file.name,
                    kind=file.format,
                    options=file.options,
                    marks=file.marks,
                    scene=scene,
                    calibration=import_calibration(
                        self.store, self.calibrations, job.task, file.format, given.calibration
                    ),
                    recording=self.settings.recording,
                    limits=self.settings.imports,
                    object_at_grasp=at_grasp,
                    motion_marks=file.motion_marks,
                    arm=self.settings.arm,
                )
                for number, file in enumerate(given.files)
            ),
        )

    def _scene_of(self, task: str, given: ImportRequest) -> Scene:
        return self.scenes.get(import_scene(self.store, task, given.scene))

    def _store_import(self, job: Job, prepared: list[PreparedImport]) -> str:
        given = from_document(ImportRequest, job.request)
        calibration = prepared[0].made[0].calibration.name
        task = Task(job.task, self._scene_of(job.task, given).name, calibration, 0, given.object_at_grasp)
        batch = [
            (each.made, self.transfers.folder(file.upload) / PREPARED_FOLDER / RECORDINGS)
            for each, file in zip(prepared, given.files, strict=True)
        ]
        outcome = self.store.finish_import(job.id, task, batch)
        self.imported(job.task)
        return outcome

    def _remove_uploads(self, job: Job) -> None:
        for file in from_document(ImportRequest, job.request).files:
            self.transfers.remove(file.upload)

    def _store_plan(self, job: Job, plan: Plan) -> str:
        return self.store.finish_planning(job.id, plan)
