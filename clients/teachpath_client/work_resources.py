"""Requests of a station about jobs, paths, plans and executions: each method is one of the REST API."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, Literal

from teachpath_client.models import (
    Adaptation,
    Dendrogram,
    Difference,
    Execution,
    ExecutorStatus,
    Job,
    JournalEntry,
    LearnedPath,
    Lease,
    MotionPreview,
    PathSummary,
    Plan,
    PlanSummary,
    Run,
    RunSummary,
    SavedVersion,
    TimeSeries,
    ToolOutput,
    Version,
)
from teachpath_client.rest import Rest


class WorkResources(Rest):
    """What a station learns, plans and executes; every method raises Unreachable or Refused."""

    _newest_execution = ""  # id of the execution that this client began last

    # jobs, and what they make

    def begin_job(self, task: str, kind: Literal["learn", "recut", "plan"], **request: Any) -> Job:
        """Queue a job; `request` is what `POST /tasks/{task}/jobs` takes for its kind."""
        return self._ask(Job, "POST", f"/tasks/{task}/jobs", {"kind": kind} | request)

    def begin_planning(
        self,
        path: str,
        version: int | None = None,
        posture: Literal["shown", "free"] = "shown",
        output: ToolOutput | None = None,
    ) -> Job:
        """Queue the planning of a path, in its newest version on the main branch or another one."""
        wanted: dict[str, Any] = {"version": version}
        wanted |= {"posture": posture} if posture != "shown" else {}  # which stations of before refuse, as the next one
        wanted |= {"output": asdict(output)} if output else {}
        return self._ask(Job, "POST", f"/paths/{path}/plans", wanted)

    def jobs(self, task: str = "", *, limit: int | None = None) -> list[Job]:
        """List a task's jobs, or all, newest first, or the newest `limit` of them."""
        return self._list(Job, _of_task("jobs", task), limit)

    def get_job(self, job: str) -> Job:
        """Return one job."""
        return self._ask(Job, "GET", f"/jobs/{job}")

    def cancel(self, job: str) -> Job:
        """Cancel a queued or running job."""
        return self._ask(Job, "POST", f"/jobs/{job}/cancel")

    def runs(self, task: str = "", *, limit: int | None = None) -> list[RunSummary]:
        """List a task's learning runs, or all, newest first, or the newest `limit` of them."""
        return self._list(RunSummary, _of_task("runs", task), limit)

    def newest_run(self, task: str) -> Run | None:
        """Return a task's newest learning run; None: nothing was learned of it yet."""
        return next((self.get_run(task, run.id) for run in self.runs(task, limit=1)), None)

    def get_run(self, task: str, run: str) -> Run:
        """Return one learning run."""
        return self._ask(Run, "GET", f"/tasks/{task}/runs/{run}")

    def dendrogram(self, task: str, run: str) -> Dendrogram:
        """Return how a run's demonstrations merge, and what other cuts would leave."""
        return self._ask(Dendrogram, "GET", f"/tasks/{task}/runs/{run}/dendrogram")

    # paths and plans

    def paths(self, task: str = "", *, limit: int | None = None) -> list[PathSummary]:
        """List a task's learned paths, or all, newest first, or the newest `limit` of them."""
        return self._list(PathSummary, "/paths", limit, **({"task": task} if task else {}))

    def get_path(self, path: str) -> LearnedPath:
        """Return the newest version of a path on its main branch."""
        return self._ask(LearnedPath, "GET", f"/paths/{path}")

    def versions(self, path: str) -> list[Version]:
        """List the versions of a path, oldest first."""
        return self._list(Version, f"/paths/{path}/versions")

    def get_version(self, path: str, number: int) -> SavedVersion:
        """Return one version and its path."""
        return self._ask(SavedVersion, "GET", f"/paths/{path}/versions/{number}")

    def save_version(self, path: str, curve: Mapping[str, Any], *, base: int, **words: str) -> Version:
        """Save an edited curve as a new version; words: branch, name, author, note."""
        return self._ask(Version, "POST", f"/paths/{path}/versions", {"base": base, "curve": curve} | words)

    def adapt(
        self, path: str, start: Mapping[str, Any] | None = None, goal: Mapping[str, Any] | None = None, **options: Any
    ) -> Adaptation:
        """Adapt a path to poses of the object, by default where it lies and where the path ends.

        Options: version, branch, name, author.
        """
        return self._ask(Adaptation, "POST", f"/paths/{path}/adaptations", {"start": start, "goal": goal} | options)

    def difference(self, path: str, first: int, second: int) -> Difference:
        """Return how far the second of two versions lies from the first."""
        return self._ask(Difference, "GET", f"/paths/{path}/versions/{first}/difference/{second}")

    def plan_summaries(self, task: str = "", *, limit: int | None = None) -> list[PlanSummary]:
        """List the plans of a task, or all, newest first, without what they hold, or the newest `limit` of them."""
        return self._list(PlanSummary, "/plans", limit, **({"task": task} if task else {}))

    def plans(self, path: str, *, limit: int | None = None) -> list[Plan]:
        """List a path's plans, newest first, or the newest `limit` of them."""
        return self._list(Plan, f"/paths/{path}/plans", limit)

    def get_plan(self, plan: str) -> Plan:
        """Return one plan with its certificate."""
        return self._ask(Plan, "GET", f"/plans/{plan}")

    def preview(self, plan: str) -> MotionPreview:
        """Return the whole motion of a plan at full speed; nothing moves."""
        return self._ask(MotionPreview, "GET", f"/plans/{plan}/motion")

    def program(self, plan: str, format: str = "csv", *, rate: float | None = None) -> bytes:
        """Return the motion of a plan as a file of another program; only a plan whose certificate holds leaves.

        Args:
            plan: id of a plan.
            format: csv, json, cdr, mcap, urscript, rapid, krl or ls.
            rate: instants a second [Hz]; None: as the format usually has.
        """
        return self._download(f"/plans/{plan}/program", **_wanted(format, rate))

    # executions

    def begin_execution(self, plan: str, *, override: float = 1.0) -> Execution:
        """Move the arm along a plan, at a share of the planned speed; return at once."""
        return self._begin("/executions", {"plan": plan, "override": override})

    def begin_teleoperation(self, tracker: str, **options: Any) -> Execution:
        """Let the arm mirror a live hand and return at once.

        Options: calibration, scene, scale, share, clutch, orientation (`keep` or `follow`).
        """
        return self._begin("/teleoperation", {"tracker": tracker} | options)

    def _begin(self, resource: str, request: Mapping[str, Any]) -> Execution:
        execution = self._ask(Execution, "POST", resource, request)
        self._newest_execution = execution.id
        return execution

    def executions(self, *, limit: int | None = None) -> list[Execution]:
        """List the executions, newest first, or the newest `limit` of them."""
        return self._list(Execution, "/executions", limit)

    def get_execution(self, execution: str) -> Execution:
        """Return how an execution stands."""
        return self._ask(Execution, "GET", f"/executions/{execution}")

    def override(self, execution: str, share: float) -> Execution:
        """Change the speed while the arm moves; 0 is a hold on the path."""
        return self._ask(Execution, "POST", f"/executions/{execution}/override", {"override": share})

    def steer(self, execution: str, verb: Literal["hold", "resume", "reverse"]) -> Execution:
        """Hold on the path, resume, or go back along it."""
        return self._ask(Execution, "POST", f"/executions/{execution}/{verb}")

    def stop(self, execution: str) -> Execution:
        """Stop and end an execution, on its path; this is not an emergency stop.

        It returns when the executor's status shows that the execution ends or has ended.

        Raises:
            NotStopped: the executor has not confirmed it; a station that answers goes on trying for a minute.
        """
        return self._stop(Execution, f"/executions/{execution}/stop")

    def stop_arm(self) -> ExecutorStatus:
        """Stop whatever moves the arm, on its path, as `stop` does; returns the status that shows it."""
        return self._stop(ExecutorStatus, "/stop")

    def acknowledge_motion(self) -> ExecutorStatus:
        """Say that you have seen why the arm moved although nothing was under way; nothing starts before."""
        return self._ask(ExecutorStatus, "POST", "/robot/acknowledge")

    def series(self, execution: str, *, points: int = 500) -> TimeSeries:
        """Return what the arm did over time, in at most `points` points."""
        return self._ask(TimeSeries, "GET", f"/executions/{execution}/series", points=points)

    def recorded_execution(self, execution: str) -> bytes:
        """Return all that was sent and done in an execution as an MCAP file."""
        return self._download(f"/executions/{execution}/recording")

    def executed_program(self, execution: str, format: str = "csv", *, rate: float | None = None) -> bytes:
        """Return what the arm was sent in an execution that has ended, as a file of another program (see `program`)."""
        return self._download(f"/executions/{execution}/program", **_wanted(format, rate))

    def get_lease(self) -> Lease:
        """Return who is in control of the arm; with an empty `holder` everybody may command."""
        return self._ask(Lease, "GET", "/lease")

    def claim_lease(self, name: str, *, seconds: float = 5.0, hold_when_lost: bool = False, ask: bool = False) -> Lease:
        """Take control of the arm, or ask its holder for it, and return the lease with its token.

        Args:
            name: under which everybody sees who is in control.
            seconds: between two beats at most; then the lease lapses.
            hold_when_lost: whether a moving arm is held on its path then.
            ask: the holder, who loses control when nothing is answered; else it is refused while somebody holds it.
        """
        claim = {"name": name, "seconds": seconds, "hold_when_lost": hold_when_lost}
        return self._ask(Lease, "POST", "/lease/ask" if ask else "/lease", claim)

    def act_on_lease(self, action: Literal["beat", "release", "keep"]) -> Lease:
        """Say that the holder of this client's lease is still there, give control back, or keep it from who asks."""
        return self._ask(Lease, "POST", f"/lease/{action}")

    def journal(self, execution: str = "", *, limit: int = 100) -> list[JournalEntry]:
        """List the newest entries of who did what to the arm, newest first."""
        return self._list(JournalEntry, "/journal", limit, execution=execution)


def _wanted(format: str, rate: float | None) -> dict[str, Any]:
    return {"format": format} | ({} if rate is None else {"rate": rate})


def _of_task(kind: str, task: str) -> str:
    """Return the list of a task, or of all where none is named."""
    return f"/tasks/{task}/{kind}" if task else f"/{kind}"
