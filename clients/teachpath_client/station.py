"""The typed client of a station: learn, plan, run, and wait for it."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal, TypeVar

from teachpath_client.control import ControlKeeper
from teachpath_client.errors import ClientError, ExecutionFaulted, JobFailed, NotInTime
from teachpath_client.events import Events
from teachpath_client.models import Demonstration, Execution, Health, Job, Plan, Run, ToolOutput
from teachpath_client.task_resources import TaskResources
from teachpath_client.work_resources import WorkResources
from teachpath_proto.control import ExecutorState

Awaited = TypeVar("Awaited", Job, Execution)

DEFAULT_OPERATOR = "a program"  # who is in control where nobody gave a name
ENDED_JOBS = ("succeeded", "failed", "cancelled")
REREAD_INTERVAL = 1.0  # [s] after which what is awaited is read again though no event came
MIN_READ_INTERVAL = 0.1  # [s] between two readings of what is awaited
# The resource that is read again, and further topics of events on which it is.
TOPICS: dict[type[Job | Execution], tuple[str, ...]] = {
    Job: ("jobs", "all"),
    Execution: ("executions", "executor", "all"),
}


def _nothing(_: object) -> None:
    pass


class Station(TaskResources, WorkResources):
    """A running station; use it as a context manager.

        with Station() as station:
            run = station.learn("demo")
            plan = station.plan(run.learned.paths[0].id)
            station.run(plan.id, override=0.5)

    Every method raises Unreachable when no station answers, and Refused with the station's sentence and record.

    Args:
        url: of the station.
        timeout: [s] for an answer.
        operator: your name, for the journal.
        lease: token of the control over the arm, where somebody has taken it.
        token: that says who you are, where the station asks; see `Rest`.
    """

    def import_file(
        self, task: str, content: bytes, *, on_change: Callable[[Job], object] = _nothing, **options: Any
    ) -> list[Demonstration]:
        """Import a file and return the demonstrations that were made of it.

        Args:
            task: whose demonstrations they become.
            content: of the file.
            on_change: called with the job whenever it has gone on.
            options: of the route: name, format, units, time, rate, columns, grasp, release, whole, scene, calibration.

        Raises:
            JobFailed: the file cannot be used; `job` says why, and nothing was stored.
        """
        outcome = self.outcome(self.begin_import(task, content, **options), on_change)
        first, last = map(int, outcome.split("-"))
        return [d for d in self.demonstrations(task) if first <= d.number <= last]

    def learn(
        self,
        task: str,
        settings: Mapping[str, Any] | None = None,
        *,
        calibrations: str = "present",
        on_change: Callable[[Job], object] = _nothing,
    ) -> Run:
        """Learn a path for every way in which a task was demonstrated, and return the run.

        Args:
            task: what was demonstrated.
            settings: of learning, laid over the station's own, e.g. `{"seed": 1}`.
            calibrations: `present` refuses demonstrations under a former version of their calibration, `recorded` not.
            on_change: called with the job whenever it has gone on.

        Raises:
            JobFailed: nothing could be learned; `job` says why.
        """
        job = self.begin_job(task, "learn", settings=dict(settings or {}), calibrations=calibrations)
        return self.get_run(task, self.outcome(job, on_change))

    def plan(
        self,
        path: str,
        version: int | None = None,
        *,
        posture: Literal["shown", "free"] = "shown",
        output: ToolOutput | None = None,
        on_change: Callable[[Job], object] = _nothing,
    ) -> Plan:
        """Plan a path and return the plan with its certificate.

        Args:
            path: id of a learned path.
            version: number of its version; None: the newest on the main branch.
            posture: `shown` prefers the joints of a demonstration that an arm showed, where there is one.
            output: of the arm that is to be on while the tool follows the path; None: none.
            on_change: called with the job whenever it has gone on.

        Raises:
            JobFailed: the arm cannot follow it; `job.failure` says where, why, and which control point to move.
        """
        return self.get_plan(self.outcome(self.begin_planning(path, version, posture, output), on_change))

    def run(
        self, plan: str, *, override: float = 1.0, on_change: Callable[[Execution], object] = _nothing
    ) -> Execution:
        """Move the arm along a plan, and return the execution when it has ended.

        This program is in control meanwhile (see `control`): when it ends or is broken off, the arm is held on its
        path. `begin_execution` begins a motion that goes on without it.

        Args:
            plan: id of a plan.
            override: share of the planned speed.
            on_change: called with the execution whenever it has gone on.

        Raises:
            ExecutionFaulted: the arm has stopped by itself.
            Refused: somebody else is in control, or the plan does not hold.
        """
        with self.control():
            return self.finish(self.begin_execution(plan, override=override), on_change)

    @contextmanager
    def control(self) -> Iterator[None]:
        """Be in control of the arm: nobody else moves it, and it is held when this program ends or hangs.

        That is noticed 3 s after the last sign of life, which a thread gives; when the block is left by an exception,
        the arm is held at once. Somebody who asks for control gets it, and then decides what the arm does; everybody
        may stop it. A client that was made with a lease keeps to that one.

        Raises:
            Refused: somebody else is in control.
        """
        if self._has_lease:
            yield
            return
        keeper = ControlKeeper(self.url, self._operator or DEFAULT_OPERATOR, self.set_lease, token=self.token)
        keeper.start()
        try:
            yield
        except BaseException as error:
            if self._hold_arm() and isinstance(error, ClientError):
                keeper.stop()
            else:  # a request may be under way still: when control lapses, the arm is held
                keeper.abandon()
            raise
        else:
            keeper.stop()

    def _hold_arm(self) -> bool:
        """Hold the arm if this program moves it, and return whether the station has answered so far."""
        try:
            if self._newest_execution and not _has_ended(self.get_execution(self._newest_execution)):
                self.steer(self._newest_execution, "hold")
        except ClientError:
            return False
        return True

    def finish(self, execution: Execution, on_change: Callable[[Execution], object] = _nothing) -> Execution:
        """Wait for an execution and return it; raises ExecutionFaulted when the arm has stopped by itself."""
        execution = self.wait(execution, on_change)
        if execution.status.state == "faulted":
            raise ExecutionFaulted(execution)
        return execution

    def outcome(self, job: Job, on_change: Callable[[Job], object] = _nothing) -> str:
        """Wait for a job and return the id of the run or plan that it made; raises JobFailed when it made none."""
        job = self.wait(job, on_change)
        if job.state != "succeeded":
            raise JobFailed(job)
        return job.outcome

    def wait(
        self, what: Awaited, on_change: Callable[[Awaited], object] = _nothing, *, timeout: float | None = None
    ) -> Awaited:
        """Wait until a job or an execution has ended, and return it.

        Args:
            what: as it was begun.
            on_change: called with it now, and whenever it has gone on.
            timeout: [s] None: as long as it takes.

        Raises:
            NotInTime: it has not ended; it goes on.
        """
        deadline = float("inf") if timeout is None else time.monotonic() + timeout
        with self.events() as events:
            while not _has_ended(what):
                on_change(what)
                if time.monotonic() > deadline:
                    raise NotInTime(f"{what.id} has not ended within {timeout:g} s; it goes on")
                _next_change(events, TOPICS[type(what)], what.id)
                what = self._ask(type(what), "GET", f"/{TOPICS[type(what)][0]}/{what.id}")
        on_change(what)
        return what

    def wait_for_arm(self, on_change: Callable[[Health], object] = _nothing, *, timeout: float = 60.0) -> Health:
        """Wait until the executor can move the arm, and return how the station is.

        Args:
            on_change: called with how it is meanwhile.
            timeout: [s].

        Raises:
            ClientError: the station says what is wrong, or it has not come in time.
        """
        deadline = time.monotonic() + timeout
        with self.events() as events:
            while (health := self.health()).executor is None:
                on_change(health)
                if "ended" in health.processes.values() or time.monotonic() > deadline:
                    raise ClientError("; ".join(health.notes) or f"the executor has not come within {timeout:g} s")
                _next_change(events, ("executor", "station"))
        return health

    def events(self) -> Events:
        """Return the events from now on; use them as a context manager."""
        return Events(self.url, token=self.token)


def _has_ended(what: Job | Execution) -> bool:
    return what.state in ENDED_JOBS if isinstance(what, Job) else ExecutorState(what.status.state).is_resting


def _next_change(events: Events, topics: Collection[str], id: str = "") -> None:
    """Return when an event of one of the topics comes, or after a while; never at once."""
    time.sleep(MIN_READ_INTERVAL)
    deadline = time.monotonic() + REREAD_INTERVAL
    while (left := deadline - time.monotonic()) > 0.0:
        event = events.next(left)
        if event is None or (event.topic in topics and event.id in ("", id)):
            return
