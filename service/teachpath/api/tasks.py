"""Tasks: make, list, and import demonstrations into one."""

from __future__ import annotations

from typing import Annotated, Final

from fastapi import APIRouter, Query, Request
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from teachpath.api.parts import Parts
from teachpath.api.strict_requests import Body
from teachpath.errors import UnusableInput
from teachpath.offline.importing import Source, import_file
from teachpath.records import Demonstration, Task
from teachpath_proto.keys import is_name, name_refusal

FILE_BODY: Final = {
    "required": True,
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}


class NewTask(Body):
    """A task to make."""

    scene: str = Field("paper", description="what stands around the arm; see /scenes")
    calibration: str = Field("identity", description="of the tracker's frame; see /calibrations")


def tasks_router(parts: Parts) -> APIRouter:
    """Return the routes of tasks."""
    router = APIRouter(tags=["tasks"])
    _add_tasks(router, parts)
    _add_demonstrations(router, parts)
    return router


def _add_tasks(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.get("/tasks")
    def list_tasks() -> list[Task]:
        """List all tasks, oldest first."""
        return store.tasks()

    @router.put("/tasks/{task}")
    def make_task(task: str, new: NewTask) -> Task:
        """Make a task; one that exists stays as it is."""
        if not is_name(task):
            raise UnusableInput(name_refusal("task", task))
        scene, calibration = parts.settings.scene(new.scene), parts.calibrations.get(new.calibration)
        return store.ensure_task(task, scene=scene.name, calibration=calibration.name)

    @router.get("/tasks/{task}")
    def get_task(task: str) -> Task:
        """Return one task."""
        return store.task(task)


def _add_demonstrations(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.get("/tasks/{task}/demonstrations")
    def list_demonstrations(task: str) -> list[Demonstration]:
        """List a task's demonstrations in their order, each with its verdict and account."""
        return store.demonstrations(store.task(task).name)

    @router.post("/tasks/{task}/demonstrations", status_code=201, openapi_extra={"requestBody": FILE_BODY})
    async def import_demonstrations(
        task: str,
        request: Request,
        name: Annotated[str, Query(description="name of the source", max_length=200)] = "upload",
        format: Annotated[str, Query(description="csv, robottasks or mcap")] = "csv",
        units: Annotated[str, Query(description="of the positions: m, cm, mm or in")] = "m",
        rate: Annotated[float, Query(description="[Hz] for a format without a clock")] = 50.0,
        scene: Annotated[str, Query(description="of a new task")] = "empty",
        calibration: Annotated[str, Query(description="of the file's frame; mcap brings its own")] = "identity",
    ) -> list[Demonstration]:
        """Import a file sent as the request's body; every motion in it becomes a demonstration."""
        content = await request.body()
        made = await run_in_threadpool(
            import_file,
            store,
            parts.settings.recording,
            Source(name, content, format, units, rate),
            task=task,
            scene=parts.settings.scene(scene),
            calibration=parts.calibrations.get(calibration),
            limits=parts.settings.imports,
        )
        for demonstration, trajectory in made:
            parts.imported(demonstration, trajectory)
        return [demonstration for demonstration, _ in made]
