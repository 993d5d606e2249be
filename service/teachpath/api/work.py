"""Jobs, and what they make: runs, learned paths and plans."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, Self

from fastapi import APIRouter, Header, Query, Request, Response
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from teachpath.api.access import TEACH, VIEW, Sender
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.names import OutputName
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body, unknown_name
from teachpath.api.versions import wanted_version
from teachpath.errors import NotFound
from teachpath.io.store.rows import Run
from teachpath.io.store.store import Store
from teachpath.learning.clustering.cuts import Dendrogram, dendrogram, recut_members
from teachpath.records import Job, LearnedPath, PathSummary, Plan, PlanSummary, RunSummary, Subject
from teachpath.records.motion import MAX_OUTPUT_REST

# The fields that each kind of job takes.
FIELDS_OF_KIND: Final = {
    "learn": {"kind", "settings", "calibrations"},
    "recut": {"kind", "run", "threshold", "clusters", "calibrations"},
    "plan": {"kind", "path", "version", "posture", "output"},
}


IdempotencyKey = Annotated[
    str,
    Header(
        alias="Idempotency-Key",
        max_length=100,
        description="a text of yours, new for each order; an order that comes again with it begins nothing, and is "
        "answered with its job",
    ),
]
WantedPosture = Annotated[
    Literal["shown", "free"],
    Field(description="plan: shown prefers the joints of a demonstration that an arm showed, where there is one"),
]
OfTask = Annotated[str | None, Query(description="name of the task; all unless given")]


class WantedOutput(Body):
    """An output of the arm that is to be on while the tool follows the path."""

    name: OutputName = Field(description="of the output, as the arm's driver knows it")
    start: float = Field(0.0, ge=0, le=MAX_OUTPUT_REST, description="rest at the start with it on [s]")
    end: float = Field(0.0, ge=0, le=MAX_OUTPUT_REST, description="rest at the end with it on [s]")


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
        None, ge=1, description="plan: number of its version; without it the newest on its main branch"
    )
    posture: WantedPosture = "shown"
    output: WantedOutput | None = Field(None, description="plan: output that is on along the path; none unless given")

    @model_validator(mode="after")
    def refuse_fields_of_other_kinds(self) -> Self:
        """Refuse a field that this kind of job does not take, like an unknown one, where it says anything.

        Clients that are generated from the description send every field, those that say nothing as their default.
        """
        said = {
            name for name, value in self if value != NewJob.model_fields[name].get_default(call_default_factory=True)
        }
        for name in said - FIELDS_OF_KIND[self.kind]:
            raise PydanticCustomError(
                "field_of_another_kind",
                unknown_name(f"field of a job {self.kind!r}", name, sorted(FIELDS_OF_KIND[self.kind])),
            )
        return self


class NewPlan(Body):
    """What to plan of a path."""

    version: int | None = Field(
        None, ge=1, description="number of the version; without it the newest on the main branch"
    )
    posture: WantedPosture = "shown"
    output: WantedOutput | None = Field(None, description="output that is on along the path; none unless given")


def jobs_router(parts: Parts) -> APIRouter:
    """Return the routes of jobs."""
    router = APIRouter(tags=["jobs"])
    store, jobs = parts.store, parts.jobs

    @router.get("/tasks/{task}/jobs", response_model=model_of(list[Job]), dependencies=VIEW)
    def list_jobs(task: str, page: WantedPage) -> Response:
        """List a task's jobs, newest first."""
        return page.answer(store.lists.jobs(store.task(task).name, page.wanted))

    @router.get("/jobs", response_model=model_of(list[Job]), dependencies=VIEW)
    def list_all_jobs(page: WantedPage) -> Response:
        """List the jobs of all tasks, newest first."""
        return page.answer(store.lists.jobs(None, page.wanted))

    @router.post(
        "/tasks/{task}/jobs",
        status_code=202,
        responses=refusals(409, 507) | located(202, "the job"),
        dependencies=TEACH,
    )
    def begin_job(
        task: str, new: NewJob, sender: Sender, request: Request, response: Response, key: IdempotencyKey = ""
    ) -> Job:
        """Queue a job; `Location` names it. It survives a restart of the service."""
        stored = store.task(task)
        if new.kind == "learn":
            parts.settings.learning_with(new.settings)
            order: dict[str, Any] = {"settings": new.settings, "calibrations": new.calibrations}
        elif new.kind == "recut":
            with named_in_body("run"):
                run = store.run(new.run)
                _of_task(stored.name, run.task, f"run {run.id!r}")
            recut_members(run.learned, threshold=new.threshold, clusters=new.clusters)
            order = {"run": run.id, "threshold": new.threshold, "clusters": new.clusters}
            order["calibrations"] = new.calibrations
        else:
            with named_in_body("path"):
                path = wanted_version(store, new.path, new.version)
                _of_task(stored.name, store.run(path.run).task, f"path {path.id!r}")
            order = _planning_order(path, new)
        submitter = submitter_of(request, sender)
        job = jobs.submit(stored.name, new.kind, order, submitter, who=sender.name, idempotency_key=key)
        return accepted(job, response)

    @router.get("/jobs/{job}", dependencies=VIEW)
    def get_job(job: str) -> Job:
        """Return one job: its state, progress, and its outcome (id of a run or a plan, numbers of demonstrations)."""
        return store.job(job)

    @router.post("/jobs/{job}/cancel", responses=refusals(409, 507), dependencies=TEACH)
    def cancel_job(job: str) -> Job:
        """Cancel a queued or running job."""
        return jobs.cancel(job)

    return router


def results_router(parts: Parts) -> APIRouter:
    """Return the routes of runs, paths and plans."""
    router = APIRouter(tags=["results"])
    _add_summaries(router, parts.store)
    _add_runs(router, parts.store)
    _add_paths(router, parts)
    return router


def _add_summaries(router: APIRouter, store: Store) -> None:
    @router.get("/runs", response_model=model_of(list[RunSummary]), dependencies=VIEW)
    def list_all_runs(page: WantedPage) -> Response:
        """List the learning runs of all tasks, newest first."""
        return page.answer(store.lists.runs(None, page.wanted))

    @router.get("/paths", response_model=model_of(list[PathSummary]), responses=refusals(404), dependencies=VIEW)
    def list_paths(page: WantedPage, task: OfTask = None) -> Response:
        """List the learned paths of a task, or of all, newest first; each is at its own address."""
        return page.answer(store.lists.path_summaries(task and store.task(task).name, page.wanted))

    @router.get("/plans", response_model=model_of(list[PlanSummary]), responses=refusals(404), dependencies=VIEW)
    def list_all_plans(page: WantedPage, task: OfTask = None) -> Response:
        """List the plans of a task, or of all, newest first; each is at its own address."""
        return page.answer(store.lists.plan_summaries(task and store.task(task).name, page.wanted))


def _add_runs(router: APIRouter, store: Store) -> None:
    @router.get("/tasks/{task}/runs", response_model=model_of(list[RunSummary]), dependencies=VIEW)
    def list_runs(task: str, page: WantedPage) -> Response:
        """List a task's learning runs, newest first; what one has learned is at its own address."""
        return page.answer(store.lists.runs(store.task(task).name, page.wanted))

    @router.get("/tasks/{task}/runs/{run}", response_model=model_of(Run), dependencies=VIEW)
    def get_run(task: str, run: str) -> Response:
        """Return one learning run: clusters, scores, dendrogram, convergence, paths."""
        stored = store.run(run)
        _of_task(store.task(task).name, stored.task, f"run {run!r}")
        return json_response(stored)

    @router.get("/tasks/{task}/runs/{run}/dendrogram", response_model=model_of(Dendrogram), dependencies=VIEW)
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

    @router.get("/paths/{path}", response_model=model_of(LearnedPath), dependencies=VIEW)
    def get_path(path: str) -> Response:
        """Return the newest version of a learned path on its main branch: degree, knots, control points, weights."""
        return json_response(store.path(path))

    @router.get("/paths/{path}/plans", response_model=model_of(list[Plan]), dependencies=VIEW)
    def list_plans(path: str, page: WantedPage) -> Response:
        """List a path's plans, newest first."""
        return page.answer(store.lists.plans(store.path(path).id, page.wanted))

    @router.post(
        "/paths/{path}/plans",
        status_code=202,
        responses=refusals(409, 507) | located(202, "the job"),
        dependencies=TEACH,
    )
    def begin_plan(
        path: str,
        sender: Sender,
        request: Request,
        response: Response,
        new: NewPlan | None = None,
        key: IdempotencyKey = "",
    ) -> Job:
        """Queue the planning of a version of a path; `Location` names the job, its outcome the plan."""
        new = new or NewPlan(version=None, output=None)
        stored = wanted_version(store, path, new.version)
        order = _planning_order(stored, new)
        task, submitter = store.run(stored.run).task, submitter_of(request, sender)
        job = jobs.submit(task, "plan", order, submitter, who=sender.name, idempotency_key=key)
        return accepted(job, response)

    @router.get("/plans/{plan}", response_model=model_of(Plan), dependencies=VIEW)
    def get_plan(plan: str) -> Response:
        """Return one plan with its certificate."""
        return json_response(store.plan(plan))


def submitter_of(request: Request, sender: Subject) -> str:
    """Return who counts as the submitter of a job: the sender, or where nobody asks for that, its address."""
    return sender.name or (request.client.host if request.client else "")


def accepted(job: Job, response: Response) -> Job:
    """Return a queued job as the answer; `Location` names it."""
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job


def _planning_order(path: LearnedPath, new: NewJob | NewPlan) -> dict[str, Any]:
    posture = {"posture": new.posture} if new.posture != "shown" else {}
    output = {"output": new.output.model_dump()} if new.output else {}
    return {"path": path.id, "version": path.version} | posture | output


def _of_task(task: str, owner: str, what: str) -> None:
    if owner != task:
        raise NotFound(f"there is no {what} in task {task}; it is of task {owner}")
