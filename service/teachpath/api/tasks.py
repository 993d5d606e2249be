"""Tasks: make, list, archive, bring back and rename them, and their demonstrations."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import Field

from teachpath.api.access import DEMONSTRATE, TEACH, VIEW
from teachpath.api.answers import located, model_of
from teachpath.api.names import DisplayName
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.errors import Conflict, UnusableInput
from teachpath.io.store.task_changes import require_open
from teachpath.records import Demonstration, Task
from teachpath_proto.keys import is_name, name_refusal


class NewTask(Body):
    """A task to make."""

    scene: str = Field("paper", description="what stands around the arm; see /scenes")
    calibration: str = Field("identity", description="of the tracker's frame; see /calibrations")
    object_at_grasp: bool = Field(
        False,
        description="the object lies where the hand grasps, anew in each demonstration, not where the scene has it",
    )
    display_name: DisplayName = Field("", description="what people call it, e.g. Küche räumen; empty: its name")


class TaskChanges(Body):
    """What is changed of a task."""

    name: str | None = Field(
        None, description="another one, in all its addresses; recordings keep the name of then; null: as it is"
    )
    display_name: DisplayName | None = Field(
        None, description="what people call it from now on; empty: its name; null: as it is"
    )


def tasks_router(parts: Parts) -> APIRouter:
    """Return the routes of tasks."""
    router = APIRouter(tags=["tasks"])
    _add_tasks(router, parts)
    _add_changes(router, parts)
    _add_demonstrations(router, parts)
    return router


def _add_tasks(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.get("/tasks", response_model=model_of(list[Task]), dependencies=VIEW)
    def list_tasks(
        page: WantedPage,
        archived: Annotated[bool, Query(description="list those that were deleted; all of them are kept")] = False,
    ) -> Response:
        """List the tasks, oldest first."""
        return page.answer(store.lists.tasks(page.wanted, archived=archived))

    @router.put("/tasks/{task}", responses=refusals(409, 507), dependencies=DEMONSTRATE)
    def make_task(task: str, new: NewTask) -> Task:
        """Make a task. One that exists stays as it is; what is asked of it and is otherwise there is refused."""
        _require_name(task)
        with named_in_body("scene"):
            scene = parts.scenes.get(new.scene)
        with named_in_body("calibration"):
            calibration = parts.calibrations.get(new.calibration)
        made = store.ensure_task(
            task,
            scene=scene.name,
            calibration=calibration.name,
            object_at_grasp=new.object_at_grasp,
            display_name=new.display_name,
        )
        _require_same(require_open(made), new)
        return made

    @router.get("/tasks/{task}", dependencies=VIEW)
    def get_task(task: str) -> Task:
        """Return one task, also one that was deleted."""
        return store.task(task)


def _add_changes(router: APIRouter, parts: Parts) -> None:
    recorder, changes = parts.recorder, parts.store.task_changes

    @router.delete("/tasks/{task}", responses=refusals(409, 507), dependencies=TEACH)
    def delete_task(task: str) -> Task:
        """Archive a task: lists leave it out, and nothing is begun with it any more. All of it is kept; see `restore`.

        It is refused while the task is being recorded, or a job of it waits or runs.
        """
        with recorder.kept_idle(task):
            archived = changes.archive(task)
        parts.leave_task(task)
        return archived

    @router.post("/tasks/{task}/restore", responses=refusals(409, 507), dependencies=TEACH)
    def restore_task(task: str) -> Task:
        """Bring back a task that was deleted, with all that was of it."""
        return changes.restore(task)

    @router.patch("/tasks/{task}", responses=refusals(409, 507) | located(200, "the task"), dependencies=TEACH)
    def rename_task(task: str, wanted: TaskChanges, response: Response) -> Task:
        """Give a task another name, with all that is of it, or another display name; `Location` is its address now.

        Its recordings stay in the folder of the name that they were recorded under: their place and hash do not change.
        """
        name = task if wanted.name is None else wanted.name
        if name == task:
            renamed = changes.rename(task, name, wanted.display_name)
        else:
            _require_name(name)
            with recorder.kept_idle(task):
                renamed = changes.rename(task, name, wanted.display_name)
        if renamed.name != task:
            parts.leave_task(task)
        response.headers["Location"] = f"/api/v1/tasks/{renamed.name}"
        return renamed


def _add_demonstrations(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.get("/tasks/{task}/demonstrations", response_model=model_of(list[Demonstration]), dependencies=VIEW)
    def list_demonstrations(task: str, page: WantedPage) -> Response:
        """List a task's demonstrations in their order, each with its verdict and account."""
        return page.answer(store.lists.demonstrations(store.task(task).name, page.wanted))


def _require_name(task: str) -> None:
    if not is_name(task):
        raise UnusableInput(name_refusal("task", task))


def _require_same(task: Task, wanted: NewTask) -> None:
    """Raise Conflict where a task is not as it is wanted; what was left out is as it is."""
    for name in sorted(wanted.model_fields_set):
        present, asked = getattr(task, name), getattr(wanted, name)
        if name == "calibration" and "@" not in asked:
            present = present.partition("@")[0]  # a name without a version means any of them
        if present != asked:
            raise Conflict(
                f"task {task.name} exists, and its {name} is {present}, not {asked}; a task keeps it: leave {name} "
                "out, or make a task of another name"
            )
