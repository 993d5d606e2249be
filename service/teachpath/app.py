"""The station: builds every part from one configuration and lets them meet; the only place where they do."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType

import numpy as np
from fastapi import FastAPI

from teachpath import __version__
from teachpath.api.events import events_router
from teachpath.api.parts import Advice, Health, Parts
from teachpath.api.station import build_api
from teachpath.api.view import view_router
from teachpath.config import Instructions, Settings, instructions
from teachpath.io.bus import Bus, listen_on_bus
from teachpath.io.bus_logins import prepare_access
from teachpath.io.signing_key import prepare_signing_key
from teachpath.io.store.store import Store
from teachpath.io.wire import recording_document
from teachpath.job_kinds import JobKinds
from teachpath.jobs.curve_assessor import CurveAssessor
from teachpath.jobs.jobs import Jobs
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.live.event_hub import EventHub
from teachpath.live.preview.preview import Preview
from teachpath.live.state_poller import Poll, StatePoller
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.planning.signature import SigningKey
from teachpath.offline.exporter import Exporter, ExportSource
from teachpath.offline.leftovers import TRANSFERS, note_unnamed, remove_leftovers
from teachpath.offline.lock import StationLock
from teachpath.offline.transfer_folders import TransferFolders
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.calibrations import Calibrations
from teachpath.recorder.guidance import GuidanceThread, read_course
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recorder import DemonstrationCallbacks, Lookup, Recorder
from teachpath.recorder.websocket_trackers import WebSocketTrackers
from teachpath.records import Array, Demonstration, Trajectory
from teachpath.robot.certificate_status import CertificateStatus
from teachpath.robot.executions import Executions
from teachpath.robot.joint_feed import JointFeed
from teachpath.robot.object_poses import ObjectPoses
from teachpath.robot.processes import SupervisedProcess, attached_command
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

log = logging.getLogger("teachpath")

# What an operator should do after the death of a process, as the end of a sentence.
EXECUTOR_SUGGESTION = "its execution ended as faulted: look where the arm stands, then start again"
SIMULATOR_SUGGESTION = "its execution ended as faulted; its arm stands at home and the object at its start: start again"


def trajectory_of(store: Store, settings: Settings, demonstration: Demonstration) -> Trajectory:
    """Return the object's trajectory of a stored demonstration, from its recording."""
    return Annotations(store, settings.recording, settings.scene).trajectory(demonstration)


class Station:
    """A running station: recorder, jobs, executor, simulated robot, preview and web application.

    Use it as a context manager; the web application `web` is served by whoever opened it.

    Raises:
        Conflict: another service uses the data folder.
        Unreachable: the Zenoh endpoint is taken.
        UnusableSettings: of the bus, its logins, certificates or keys.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._lock = StationLock(Path(settings.store.data_dir))
        self._lock.__enter__()
        try:
            self._signing_key = SigningKey(prepare_signing_key(settings.bus.endpoint))
            self._access = prepare_access(settings.bus)
            self.bus: Bus = listen_on_bus(settings.bus, self._access)
        except BaseException:
            self._lock.__exit__(None, None, None)
            raise
        self.keys = Keys(settings.bus.prefix)
        self._shown = ""
        self._started = time.monotonic()
        self._open_recording()
        self._open_work()
        self._open_robot()
        self.web: FastAPI = build_api(self._parts(), view_router(self.preview), events_router(self.event_hub))
        self._state_poller = StatePoller(self.event_hub, self._polls())

    def __enter__(self) -> Station:
        note_unnamed(self.store)
        try:
            self.preview.start()
            self.guidance.start()
            self.recorder.start()
            self._queries.start()
            self.executions.start()
            self.objects.start()
            self.certificate_status.start()
            self.joints.start()
            self._state_poller.start()
            for process in self.processes:
                process.start()
            remove_leftovers(Path(self.settings.store.data_dir), self.store.awaited_uploads())
            self.jobs.start()
            if tasks := self.store.tasks():
                self._show_task(tasks[-1].name)
                self.assessor.warm_up()
            else:
                self.preview.show_object(self.settings.scenes[0].carried)
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._state_poller.stop()
        self.processes[0].request_stop()
        self._queries.stop()
        self.recorder.stop()
        self.reader.stop()
        self.guidance.stop()
        self.jobs.stop()
        self.assessor.stop()
        self.exporter.stop()
        self.certificate_status.stop()
        self.objects.stop()
        for process in self.processes:
            process.stop()
        self.executions.stop()  # after the executor, whose last status is the end of what was under way
        self.joints.stop()
        self.preview.stop()
        self.bus.close()
        self.store.close()
        self._lock.__exit__(None, None, None)

    def _open_recording(self) -> None:
        """Open the store, what knows where the objects lie, and all that records."""
        settings = self.settings
        self.event_hub = EventHub()
        self.store = Store(settings.store, changed=self.event_hub.publish_change)
        self.reader = LimitedProcess(settings.jobs)
        self.calibrations = Calibrations(
            self.store, settings.recording, settings.calibrations, settings.scene, self.reader.call
        )
        self.executions = Executions(self.bus, self.keys, self.store, robot=settings.bus.robot)
        self.objects = ObjectPoses(self.bus, self.keys, settings.scene, self.executions.is_moving, self._show_object)
        self.recorder = Recorder(
            self.bus,
            self.keys,
            self.store,
            settings.recording,
            Lookup(settings.scene, self.calibrations.get, self.objects.reported),
            DemonstrationCallbacks(
                added=lambda demonstration, trajectory: self._show_task(demonstration.task),
                changed=lambda demonstration: self._show_task(demonstration.task),
            ),
            call=self.reader.call,
        )
        self._queries = RecorderQueries(self.bus, self.keys, self.recorder)
        self.guidance = GuidanceThread(self.store.demonstrations, self._course, settings.learning, self.reader.call)
        self.websocket_trackers = WebSocketTrackers(self.bus, self.keys, self.recorder)

    def _open_work(self) -> None:
        """Open what learns, plans and looks at curves."""
        settings = self.settings
        self.assessor = CurveAssessor()
        self.transfers = TransferFolders(Path(settings.store.data_dir) / TRANSFERS)
        kinds = JobKinds(
            self.store, settings, self.calibrations, self.transfers, self._show_task, self._signing_key, self.objects
        ).by_name()
        self.jobs = Jobs(self.bus, self.keys, self.store, settings.jobs, kinds, on_finished=self.assessor.on_finished)
        self.exporter = Exporter(ExportSource(settings.store, settings.recording, settings.scenes), settings.jobs)

    def _open_robot(self) -> None:
        """Open the service's side of the arm, its picture, and the processes that move it."""
        settings, robot = self.settings, self.settings.bus.robot
        self.joints = JointFeed(self.bus, self.keys, robot=robot)
        self.certificate_status = CertificateStatus(
            self.bus, self.keys, self.store, scene=self.objects.scene, calibration=self.calibrations.newest_numbered
        )
        self.preview = Preview(
            self.bus,
            self.keys,
            visual_solids(settings.arm.tool_length),
            arm=settings.arm,
            robot=robot,
            home=np.array(settings.motion.home),
            statuses=self.recorder.shown_statuses,
            settings=settings.preview,
        )
        # In the order in which they are stopped: the executor brings the arm to rest.
        self.processes = [
            self._process(
                "executor",
                Role.EXECUTOR,
                EXECUTOR_SUGGESTION,
                self.executions.end_lost,
                key=self._signing_key.secret,
            )
        ]
        if settings.simulator.start:
            self.processes.append(self._process("simulator", Role.ROBOT, SIMULATOR_SUGGESTION))

    def _process(
        self,
        name: str,
        role: Role,
        suggestion: str,
        on_death: Callable[[str], None] = lambda cause: None,
        *,
        key: bytes = b"",
    ) -> SupervisedProcess:
        login = self._access.login(role) if self._access else None
        given = instructions(Instructions(self.settings, login, key))
        return SupervisedProcess(name, attached_command(name), given, suggestion=suggestion, on_death=on_death)

    def _course(self, demonstration: Demonstration) -> Array:
        carried = self.recorder.annotations.carried(demonstration)
        return self.reader.call(read_course, self.store.recordings, demonstration, carried)

    def health(self) -> Health:
        """Say which parts run, and what an operator should know."""
        return Health(
            version=__version__,
            uptime=round(time.monotonic() - self._started, 1),
            bus=self.settings.bus,
            processes={process.name: process.state for process in self.processes},
            recording=tuple(sorted(status.tracker for status in self.recorder.statuses())),
            backlog=self.recorder.backlog,
            longest_backlog=self.settings.recording.longest_backlog,
            trackers=tuple(self.recorder.trackers()),
            guidance=Advice(self._shown, self.guidance.advice(self._shown)),
            executor=self.executions.status,
            notes=tuple(self.notes()),
        )

    def notes(self) -> list[str]:
        """Say what an operator should know."""
        notes = [note for process in self.processes if (note := process.note())]
        notes += self.recorder.faults() + self.executions.faults() + self.store.health.faults()
        notes += self._access.notes(datetime.now(UTC)) if self._access else []
        if (unfinished := self.store.recordings.unfinished()) and not self.recorder.statuses():
            notes.append(f"{len(unfinished)} recordings were cut off; stop the service and run: teachpath doctor")
        return notes

    def _polls(self) -> dict[str, Poll]:
        """Return by topic how to read the states that no row of the store holds."""
        return {
            "recordings": lambda: {
                s.tracker: recording_document(s) for s in self.recorder.statuses(with_statistics=True)
            },
            "trackers": lambda: {
                t.name: {"announced": t.announced, "silent": t.is_silent} for t in self.recorder.trackers()
            },
            "guidance": lambda: {task: {"sentence": said} for task, said in self.guidance.all_advice().items()},
            "station": lambda: {"": {"version": __version__, "notes": self.notes()}},
            "executor": lambda: {"": asdict(status)} if (status := self.executions.status) else {},
        }

    def _parts(self) -> Parts:
        return Parts(
            settings=self.settings,
            store=self.store,
            recorder=self.recorder,
            calibrations=self.calibrations,
            jobs=self.jobs,
            assessor=self.assessor,
            executions=self.executions,
            websocket_trackers=self.websocket_trackers,
            joints=self.joints,
            objects=self.objects,
            trajectory=self.recorder.annotations.trajectory,
            reader=self.reader,
            health=self.health,
            transfers=self.transfers,
            exporter=self.exporter,
        )

    def _show_task(self, task: str) -> None:
        """Show a task whose demonstrations have changed: in the guidance, and its object in the preview."""
        self._shown = task
        self.guidance.request(task)
        self._show_object()

    def _show_object(self, _: str = "") -> None:
        """Show the object of the task that is shown, where it lies."""
        if self._shown:
            self.preview.show_object(self.objects.scene(self.store.task(self._shown).scene).carried)
