"""Adaptation of a path to an object and a goal that lie elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from fastapi import APIRouter, Request, Response
from pydantic import Field

from teachpath.api.access import TEACH, VIEW, Sender, signed
from teachpath.api.adaptation_inputs import shown_for
from teachpath.api.adaptation_orders import Adaptation, answer_of, order_of
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.parts import Parts
from teachpath.api.poses import Position, Quaternion
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.api.versions import BRANCH_PATTERN, LINE_PATTERN, wanted_version
from teachpath.api.work import IdempotencyKey, submitter_of
from teachpath.editing import check_editable
from teachpath.errors import Outdated, UnusableInput
from teachpath.io.store.store import Store
from teachpath.io.store.versions import Edit
from teachpath.jobs.idempotency import ORDER_KEY, begun_by
from teachpath.learning.adaptation.adapted_course import AdaptationModel
from teachpath.learning.adaptation.target import Target
from teachpath.records import Array, Job, LearnedPath, ObjectPose, Scene, Version
from teachpath.records.poses import SAME_PLACE, unit_quaternion

if TYPE_CHECKING:  # computed in another process
    from teachpath.learning.adaptation.adapt import AdaptedPath


class TargetPose(Body):
    """Where a path is to begin or to end, in the world."""

    position: Position = Field(description="x, y, z of its centre [m]")
    orientation: Quaternion | None = Field(
        None, description="quaternion w, x, y, z, on a path that has learned orientations; left out: as learned"
    )


class NewAdaptation(Body):
    """Where the object lies and where it is to go."""

    start: TargetPose | None = Field(None, description="left out: where the object of the task's scene lies")
    goal: TargetPose | None = Field(None, description="left out: where the version ends")
    version: int | None = Field(None, ge=1, description="to adapt; without it the newest on the main branch")
    branch: str = Field(
        "", max_length=64, pattern=BRANCH_PATTERN, description="to continue or to begin; empty: the branch of the base"
    )
    name: str = Field("adapted", max_length=80, pattern=LINE_PATTERN, description="what to call the new version")
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who asked for it")


UNCHANGED_ANSWER: Final[dict[str, Any]] = {
    "model": model_of(Adaptation),
    "description": "It begins and ends there already: no new version.",
}


def adaptations_router(parts: Parts) -> APIRouter:
    """Return the route of adaptations."""
    router = APIRouter(tags=["versions"])
    store, versions = parts.store, parts.store.versions

    @router.post(
        "/paths/{path}/adaptations",
        status_code=201,
        response_model=model_of(Adaptation),
        responses={200: UNCHANGED_ANSWER | located(200, "the version")[200]}
        | located(201, "the version")
        | refusals(409, 507),
        dependencies=TEACH,
    )
    def adapt_path(
        path: str, wanted: NewAdaptation, sender: Sender, request: Request, key: IdempotencyKey = ""
    ) -> Response:
        """Adapt a path to another start and goal of the object: a new version, and a job that certifies it.

        The shape is learned from all demonstrations of the run that do the task in the same way, wherever they did it.
        The version takes the object where it begins; its plans start when the object lies there (PUT
        /scenes/{scene}/object).
        """
        base = wanted_version(store, path, wanted.version)
        task, submitter = store.open_task(store.run(base.run).task).name, submitter_of(request, sender)
        ordered = {"path": path, "adaptation": wanted.model_dump(mode="json")}

        def earlier_job() -> Job | None:
            return begun_by(store, task, "plan", {ORDER_KEY: ordered}, submitter, key)

        if known := earlier_job():
            return answer_of(store, known)
        parts.jobs.require_room(submitter)
        try:
            order = _saved_order(parts, base, wanted, signed(sender, wanted.author), ordered)
        except Outdated:
            if known := earlier_job():  # the same order came at the same time
                return answer_of(store, known)
            raise
        job = parts.jobs.submit(task, "plan", order, submitter, who=sender.name, idempotency_key=key)
        return answer_of(store, job)

    @router.get(
        "/paths/{path}/versions/{number}/adaptation-model",
        response_model=model_of(AdaptationModel),
        responses=refusals(409),
        dependencies=VIEW,
    )
    def get_adaptation_model(path: str, number: int) -> Response:
        """Return what a version between other ends is computed from, so that a page can draw it while it is dragged."""
        base = versions.get(path, number)[1]
        shown = shown_for(parts, store.run(base.run), base)
        return json_response(parts.assessor.adaptation_model(base, shown))

    return router


def _saved_order(
    parts: Parts, base: LearnedPath, wanted: NewAdaptation, author: str, ordered: dict[str, Any]
) -> dict[str, Any]:
    """Adapt a path, save it, and return the order to certify it."""
    run = parts.store.run(base.run)
    scene = parts.objects.scene(parts.store.task(run.task).scene)
    target = _target(base, scene, wanted)
    adapted = parts.assessor.adapt(base, shown_for(parts, run, base), target)
    saved = _saved(parts.store, base, wanted, author, adapted, _object_pose(scene, target))
    return order_of(saved, ordered, adapted, base.version)


def _saved(
    store: Store,
    base: LearnedPath,
    wanted: NewAdaptation,
    author: str,
    adapted: AdaptedPath,
    object_pose: ObjectPose | None,
) -> Version:
    """Save an adapted path, unless it is the base as it is; return the version."""
    present = store.versions.get(base.id, base.version)[0]
    if adapted.is_base and wanted.branch.strip() in ("", present.branch):
        return present
    edit = Edit(base.version, wanted.branch.strip(), wanted.name.strip(), author, adapted.note)
    curve = check_editable(adapted.curve)
    return store.versions.save(base.id, curve, edit, orientation=adapted.orientation, object_pose=object_pose)


def _target(base: LearnedPath, scene: Scene, wanted: NewAdaptation) -> Target:
    start, goal = base.curve(np.array([0.0, 1.0]))
    turned = turned_goal = None
    if wanted.goal is not None:
        goal, turned_goal = _pose(wanted.goal, "goal")
    if wanted.start is not None:
        start, turned = _pose(wanted.start, "start")
    elif scene.carried is None:
        raise UnusableInput(
            f"scene {scene.name} has no object, so nothing tells where the path is to begin; give a start"
        )
    elif np.linalg.norm(np.array(scene.carried.position) - start) > SAME_PLACE:
        start = np.array(scene.carried.position)
    return Target(start, goal, turned, turned_goal)


def _object_pose(scene: Scene, target: Target) -> ObjectPose | None:
    """Return where a path takes the object; None in a scene without one."""
    if scene.carried is None:
        return None
    x, y, z = map(float, target.start)
    return ObjectPose((x, y, z), scene.carried.orientation)


def _pose(pose: TargetPose, place: str) -> tuple[Array, Array | None]:
    position = np.array(pose.position)
    if pose.orientation is None:
        return position, None
    return position, np.array(unit_quaternion(pose.orientation, f"{place}.orientation"))
