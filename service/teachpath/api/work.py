"""Jobs, and what they make: runs, learned paths and plans."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, Self

from fastapi import APIRouter, Query, Request, Response
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from teachpath.api.answers import json_response, model_of
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.strict_requests import Body, unknown_name
from teachpath.errors import NotFound
from teachpath.io.store.rows import Run
from teachpath.io.store.store import Store
from teachpath.learning.clustering.cuts import Dendrogram, dendrogram, recut_members
from teachpath.records import Job, LearnedPath, Plan, RunSummary

# The fields that each kind of job takes.
FIELDS_OF_KIND: Final = {
    "learn": {"kind", "settings", "calibrations"},
    "recut": {"kind", "run", "threshold", "clusters", "calibrations"},
    "plan": {"kind", "path", "version"},
}


class NewJob(Body):
    """Work to begin on a task."""

    kind: Literal["learn", "recut", "plan"] = Field(
        "learn",
        description="learn: cluster, select, fit; recut: cut a run's dendrogram elsewhere, select, fit; "
        "plan: certify one path",
    )
    settings: dict[str, Any] = Field(default_factory=dict, description="learn: settings laid over the station's own")
    run: str = Field("", description="recut: id of the run whose dendrogram is cut; its settings are kept")
    threshold: float | None = Field(None, description="recut: height of the cut [m]")
    clusters: int | None = Field(None, description="recut: or the number of clusters")
    calibrations: Literal["present", "recorded"] = Field(
        "present",
        description="learn, recut: present refuses demonstrations under a former version of their calibration",
    )
    path: str = Field("", description="plan: id of the learned path")
    version: int | None = Field(
        None, description="plan: number of its version; without it the newest on its main branch"
    )

    @model_validator(mode="after")
    def refuse_fields_of_other_kinds(self) -> Self:
        """Refuse a field that this kind of job does not take, like an unknown one."""
        for name in self.model_fields_set - FIELDS_OF_KIND[self.kind]:
            raise PydanticCustomError(
                "field_of_another_kind",
                unknown_name(f"field of a job {self.kind!r}", name, sorted(FIELDS_OF_KIND[self.kind])),
            )
        return self


class NewPlan(Body):
    """What to plan of a path."""

    version: int | None = Field(None, description="number of the version; without it the newest on the main branch")


def jobs_router(parts: Parts) -> APIRouter:
    """Return the routes of jobs."""
    router = APIRouter(tags=["jobs"])
    store, jobs = parts.store, parts.jobs

    @router.get("/tasks/{task}/jobs", response_model=model_of(list[Job]))
    def list_jobs(task: str, page: WantedPage) -> Response:
        """List a task's jobs, newest first."""
        return page.answer(store.lists.jobs(store.task(task).name, page.wanted))

    @router.post("/tasks/{task}/jobs", status_code=202)
    def begin_job(task: str, new: NewJob, request: Request, response: Response) -> Job:
        """Queue a job; `Location` names it. It survives a restart of the service."""
        stored = store.task(task)
        if new.kind == "learn":
            parts.settings.learning_with(new.settings)
            order: dict[str, Any] = {"settings": new.settings, "calibrations": new.calibrations}
        elif new.kind == "recut":
            run = store.run(new.run)
            _of_task(stored.name, run.task, f"run {run.id!r}")
            recut_members(run.learned, threshold=new.threshold, clusters=new.clusters)
            order = {"run": run.id, "threshold": new.threshold, "clusters": new.clusters}
            order["calibrations"] = new.calibrations
        else:
            path = _versioned(store, new.path, new.version)
            _of_task(stored.name, store.run(path.run).task, f"path {path.id!r}")
            order = {"path": path.id, "version": path.version}
        return accepted(jobs.submit(stored.name, new.kind, order, submitter_of(request)), response)

    @router.get("/jobs/{job}")
    def get_job(job: str) -> Job:
        """Return one job: its state, progress, and its outcome (id of a run or a plan, numbers of demonstrations)."""
        return store.job(job)

    @router.post("/jobs/{job}/cancel")
    def cancel_job(job: str) -> Job:
        """Cancel a queued or running job."""
        return jobs.cancel(job)

    return router


def results_router(parts: Parts) -> APIRouter:
    """Return the routes of runs, paths and plans."""
    router = APIRouter(tags=["results"])
    _add_runs(router, parts.store)
    _add_paths(router, parts)
    return router


def _add_runs(router: APIRouter, store: Store) -> None:
    @router.get("/tasks/{task}/runs", response_model=model_of(list[RunSummary]))
    def list_runs(task: str, page: WantedPage) -> Response:
        """List a task's learning runs, newest first; what one has learned is at its own address."""
        return page.answer(store.lists.runs(store.task(task).name, page.wanted))

    @router.get("/tasks/{task}/runs/{run}", response_model=model_of(Run))
    def get_run(task: str, run: str) -> Response:
        """Return one learning run: clusters, scores, dendrogram, convergence, paths."""
        stored = store.run(run)
        _of_task(store.task(task).name, stored.task, f"run {run!r}")
        return json_response(stored)

    @router.get("/tasks/{task}/runs/{run}/dendrogram", response_model=model_of(Dendrogram))
    def get_dendrogram(
        task: str,
        run: str,
        most: Annotated[int, Query(ge=1, le=200, description="clusters that a listed cut leaves at most")] = 30,
    ) -> Response:
        """Return how the run's demonstrations merge, ready to be drawn, and what other cuts would leave.

        `leaves` are the demonstrations from left to right; the members of every cluster of every cut are neighbours
        there, so `leaf_ranges` of a cut are slices of it. `merges` are left, right, height [m] and members, numbered
        on from the demonstrations, which are numbered as listed. A job of kind `recut` makes a new run of another cut.
        """
        stored = store.run(run)
        _of_task(store.task(task).name, stored.task, f"run {run!r}")
        return json_response(dendrogram(stored.learned, most))


def _add_paths(router: APIRouter, parts: Parts) -> None:
    store, jobs = parts.store, parts.jobs

    @router.get("/paths/{path}", response_model=model_of(LearnedPath))
    def get_path(path: str) -> Response:
        """Return the newest version of a learned path on its main branch: degree, knots, control points, weights."""
        return json_response(store.path(path))

    @router.get("/paths/{path}/plans", response_model=model_of(list[Plan]))
    def list_plans(path: str, page: WantedPage) -> Response:
        """List a path's plans, newest first."""
        return page.answer(store.lists.plans(store.path(path).id, page.wanted))

    @router.post("/paths/{path}/plans", status_code=202)
    def begin_plan(path: str, request: Request, response: Response, new: NewPlan | None = None) -> Job:
        """Queue the planning of a version of a path; `Location` names the job, its outcome the plan."""
        stored = _versioned(store, path, new.version if new else None)
        order = {"path": stored.id, "version": stored.version}
        return accepted(jobs.submit(store.run(stored.run).task, "plan", order, submitter_of(request)), response)

    @router.get("/plans/{plan}", response_model=model_of(Plan))
    def get_plan(plan: str) -> Response:
        """Return one plan with its certificate."""
        return json_response(store.plan(plan))


def submitter_of(request: Request) -> str:
    """Return who counts as the submitter of a job: the address that the request comes from."""
    return request.client.host if request.client else ""


def accepted(job: Job, response: Response) -> Job:
    """Return a queued job as the answer; `Location` names it."""
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job


def _versioned(store: Store, path: str, version: int | None) -> LearnedPath:
    return store.path(path) if version is None else store.versions.get(path, version)[1]


def _of_task(task: str, owner: str, what: str) -> None:
    if owner != task:
        raise NotFound(f"there is no {what} in task {task}; it is of task {owner}")
