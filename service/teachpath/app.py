"""The station: builds every part from one configuration and lets them meet; the only place where they do."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from fastapi import FastAPI

from teachpath import __version__
from teachpath.access.access import Access
from teachpath.access.audit import Audit
from teachpath.access.provider_sign_in import open_provider
from teachpath.access.proxy_people import require_roles
from teachpath.api.events import events_router
from teachpath.api.live_messages import StationState
from teachpath.api.parts import Advice, Health, Parts
from teachpath.api.station import build_api
from teachpath.api.view import view_router
from teachpath.config import Settings
from teachpath.instructions import Instructions, instructions
from teachpath.io.audit_log import AuditLog
from teachpath.io.bus import Bus, listen_on_bus
from teachpath.io.bus_logins import prepare_access
from teachpath.io.signing_key import prepare_signing_key
from teachpath.io.store.changes import ALL_TOPICS
from teachpath.io.store.store import Store
from teachpath.io.wire import recording_document
from teachpath.job_kinds import JobKinds
from teachpath.jobs.curve_assessor import CurveAssessor
from teachpath.jobs.jobs import Jobs
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.live.event_hub import EventHub
from teachpath.live.preview.asset_paths import has_documents
from teachpath.live.preview.preview import Preview
from teachpath.live.row_status import status_of
from teachpath.live.shown_task import ShownTask
from teachpath.live.state_poller import Poll, StatePoller
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.planning.signature import SigningKey
from teachpath.offline.exporter import Exporter, ExportSource
from teachpath.offline.leftovers import TRANSFERS, note_unnamed, remove_leftovers
from teachpath.offline.lock import StationLock
from teachpath.offline.staging import abandoned_notes
from teachpath.offline.transfer_folders import TransferFolders
from teachpath.periodic_thread import Startable, Stoppable
from teachpath.realtime import realtime_threads
from teachpath.recorder.calibrations import Calibrations
from teachpath.recorder.guidance import GuidanceThread, read_course
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import DemonstrationCallbacks, Lookup
from teachpath.recorder.websocket_trackers import WebSocketTrackers
from teachpath.records import Array, Demonstration
from teachpath.robot.arm_lease import ArmLease
from teachpath.robot.certificate_status import CertificateStatus
from teachpath.robot.executions import Executions
from teachpath.robot.joint_feed import JointFeed
from teachpath.robot.object_poses import ObjectPoses
from teachpath.robot.processes import EXECUTOR_SUGGESTION, SIMULATOR_SUGGESTION, SupervisedProcess, attached
from teachpath.robot.programs import Programs
from teachpath.robot.scenes import Scenes
from teachpath.stored_arm import open_store
from teachpath.web.certificate import WebCertificate, find_certificate
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role


class Station:
    """A running station: recorder, jobs, executor, simulated robot, preview and web application.

    Use it as a context manager; the web application `web` is served by whoever opened it.

    Raises:
        Conflict: another service uses the data folder.
        Unreachable: the Zenoh endpoint is taken.
        UnusableSettings: of the bus, its logins, certificates or keys, or of the provider at which people sign in.
    """

    def __init__(self, settings: Settings) -> None:
        require_roles(settings.auth.mode, settings.proxy)
        self._provider = open_provider(settings.auth.mode, settings.oidc)
        self.event_hub: EventHub = EventHub()
        with ExitStack() as on_failure:
            self._lock = on_failure.enter_context(StationLock(Path(settings.store.data_dir)))
            store, settings = open_store(settings, self._on_change)
            self.store: Store = store
            self.settings: Settings = settings
            on_failure.callback(self.store.close)
            self.store.services.begin()
            self.certificate: WebCertificate | None = find_certificate(settings.web, settings.store.data_dir)
            self._authority = bool(self.certificate and self.certificate.authority)
            self._signing_key = SigningKey(prepare_signing_key(settings.bus.endpoint))
            self._access = prepare_access(settings.bus)
            with realtime_threads():
                self.bus: Bus = listen_on_bus(settings.bus, self._access)
            on_failure.pop_all()
        self.keys: Keys = Keys(settings.bus.prefix)
        self._started = time.monotonic()
        self._open_recording()
        self._open_work()
        self._open_robot()
        self.web: FastAPI = build_api(self._parts(), view_router(self.preview), events_router(self.event_hub))
        self._state_poller = StatePoller(self.event_hub, self._polls())

    def __enter__(self) -> Station:
        note_unnamed(self.store)
        try:
            first: tuple[Startable, ...] = (self.audit, self.access, self.preview, self.guidance, self.recorder)
            then: tuple[Startable, ...] = (self._queries, self.executions, self.objects, self.certificate_status)
            for part in (*first, *then, self.joints, self._state_poller, self.store.spool, *self.processes):
                part.start()
            remove_leftovers(Path(self.settings.store.data_dir), self.store.awaited_uploads())
            self.jobs.start()
            self.lease.start()
            self._shown.show_newest()
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        self._state_poller.stop()
        self.access.stop()
        self.lease.stop()
        self.processes[0].request_stop()
        first: tuple[Stoppable, ...] = (self._queries, self.recorder, self.reader, self.mesh_reader, self.guidance)
        then: tuple[Stoppable, ...] = (self.jobs, self.assessor, self.exporter, self.certificate_status, self.objects)
        for part in (*first, *then, *self.processes, self.executions, self.joints, self.preview):
            part.stop()  # executions after the executor, whose last status is the end of what was under way
        self.bus.close()
        self.audit.stop()
        self.store.close()
        self._lock.__exit__(None, None, None)

    def _open_recording(self) -> None:
        """Open what knows where the objects lie, and all that records."""
        settings, store, tokens, people = self.settings, self.store, self.store.access_tokens, self.store.people
        self.audit: Audit = Audit(AuditLog(Path(settings.store.data_dir)))
        self.access: Access = Access(
            settings.auth, tokens, people, oidc=settings.oidc, provider=self._provider, proxy=settings.proxy
        )
        self.reader: LimitedProcess = LimitedProcess(settings.jobs)
        self.mesh_reader: LimitedProcess = LimitedProcess(settings.jobs, "reading the mesh", part="mesh reader")
        self.scenes: Scenes = Scenes(self.store.scenes, settings.scenes)
        scene, call, note = self.scenes.get, self.reader.call, self.audit.note_journal
        self.calibrations: Calibrations = Calibrations(store, settings.recording, settings.calibrations, scene, call)
        self.executions: Executions = Executions(self.bus, self.keys, store, note, robot=settings.bus.robot)
        self.objects: ObjectPoses = ObjectPoses(
            self.bus, self.keys, scene, self.executions.is_moving, lambda scene: self._shown.show_scene()
        )
        lookup = Lookup(scene, self.calibrations.get, self.objects.reported)
        callbacks = DemonstrationCallbacks(
            added=lambda demonstration, trajectory: self._shown.show(demonstration.task),
            changed=lambda demonstration: self._shown.show(demonstration.task),
        )
        self.recorder: Recorder = Recorder(self.bus, self.keys, store, settings.recording, lookup, callbacks, call=call)
        self._queries = RecorderQueries(self.bus, self.keys, self.recorder)
        self.guidance: GuidanceThread = GuidanceThread(store.demonstrations, self._course, settings.learning, call)
        self.websocket_trackers: WebSocketTrackers = WebSocketTrackers(self.bus, self.keys, self.recorder)
        self._shown = ShownTask(
            self.store,
            self.objects.scene,
            lambda: self.scenes.all()[0],
            lambda carried: self.preview.show_object(carried),  # the preview is opened later
            self.guidance.request,
        )

    def _open_work(self) -> None:
        """Open what learns, plans and looks at curves."""
        settings, store, scenes, show = self.settings, self.store, self.scenes, self._shown.show
        self.assessor: CurveAssessor = CurveAssessor()
        self.transfers: TransferFolders = TransferFolders(Path(settings.store.data_dir) / TRANSFERS)
        kinds = JobKinds(
            store, settings, self.calibrations, self.transfers, show, self._signing_key, scenes, self.objects
        ).by_name()
        self.jobs: Jobs = Jobs(self.bus, self.keys, store, settings.jobs, kinds, on_finished=self.assessor.on_finished)
        source = ExportSource(settings.store, settings.recording, settings.scenes)
        self.exporter: Exporter = Exporter(source, settings.jobs)

    def _open_robot(self) -> None:
        """Open the service's side of the arm, its picture, and the processes that move it."""
        settings, robot, store = self.settings, self.settings.bus.robot, self.store
        self.joints: JointFeed = JointFeed(self.bus, self.keys, robot=robot)
        self.certificate_status: CertificateStatus = CertificateStatus(
            self.bus, self.keys, store, scene=self.objects.scene, calibration=self.calibrations.newest_numbered
        )
        self.programs: Programs = Programs(
            store, self._signing_key, settings.motion, settings.arm, self.executions, self.reader.call, time.time_ns
        )
        self.preview: Preview = Preview(
            self.bus,
            self.keys,
            visual_solids(settings.arm),
            arm=settings.arm,
            robot=robot,
            home=np.array(settings.motion.home),
            statuses=self.recorder.shown_statuses,
            settings=settings.preview,
        )
        # In the order in which they are stopped: the executor brings the arm to rest.
        key, on_death = self._signing_key.secret, self.executions.end_lost
        executor = self._process("executor", Role.EXECUTOR, EXECUTOR_SUGGESTION, on_death, key=key)
        self.processes: list[SupervisedProcess] = [executor]
        self.lease: ArmLease = ArmLease(store.services, executor)
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
        settings = self.settings.model_copy(update={"scenes": tuple(self.scenes.all())})
        given = instructions(Instructions(settings, login, key))
        return SupervisedProcess(name, attached(name), given, suggestion=suggestion, on_death=on_death)

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
            guidance=Advice(self._shown.name, self.guidance.advice(self._shown.name)),
            executor=self.executions.status,
            notes=tuple(self.notes()),
            display_name=self.settings.web.display_name,
        )

    def notes(self) -> list[str]:
        """Say what an operator should know."""
        notes = [note for process in self.processes if (note := process.note())]
        notes += self.recorder.faults() + self.executions.faults() + self.store.health.faults()
        notes += self.store.spool.faults() + (self._access.notes(datetime.now(UTC)) if self._access else [])
        notes += self.access.notes() + self.audit.notes() + self.scenes.notes + self.lease.notes()
        notes += self.certificate.notes(datetime.now(UTC)) if self.certificate else []
        notes += self.store.recordings.notes(self.recorder.is_writing)
        return notes + abandoned_notes(Path(self.settings.store.data_dir))

    def _polls(self) -> dict[str, Poll]:
        """Return by topic how to read the states that no row of the store holds."""
        statuses, trackers, notes = self.recorder.statuses, self.recorder.trackers, self.notes
        own = self.store.services.station, self.settings.web.display_name
        return {
            "recordings": lambda: {s.tracker: recording_document(s) for s in statuses(with_statistics=True)},
            "trackers": lambda: {t.name: {"announced": t.announced, "silent": t.is_silent} for t in trackers()},
            "guidance": lambda: {task: {"sentence": said} for task, said in self.guidance.all_advice().items()},
            "station": lambda: {"": asdict(StationState(__version__, notes(), self._authority, has_documents(), *own))},
            "executor": lambda: {"": asdict(status)} if (status := self.executions.status) else {},
        }

    def _parts(self) -> Parts:
        return Parts(
            settings=self.settings,
            access=self.access,
            audit=self.audit,
            certificate=self.certificate,
            store=self.store,
            recorder=self.recorder,
            calibrations=self.calibrations,
            jobs=self.jobs,
            assessor=self.assessor,
            executions=self.executions,
            programs=self.programs,
            websocket_trackers=self.websocket_trackers,
            joints=self.joints,
            scenes=self.scenes,
            objects=self.objects,
            reader=self.reader,
            mesh_reader=self.mesh_reader,
            health=self.health,
            transfers=self.transfers,
            exporter=self.exporter,
            leave_task=self._shown.leave,
        )

    def _on_change(self, table: str, key: str) -> None:
        """Publish a row that has changed, here or by another station; of a scene, show the object anew."""
        self.event_hub.publish_change(table, key, status_of(self.store, table, key))
        if table in ("scenes", ALL_TOPICS):
            self._shown.show_scene()
