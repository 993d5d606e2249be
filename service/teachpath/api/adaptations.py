"""Adaptation of a path to an object and a goal that lie elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from fastapi import APIRouter, Response
from pydantic import Field

from teachpath.api.access import TEACH, VIEW, Sender, signed
from teachpath.api.adaptation_inputs import shown_for
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.parts import Parts
from teachpath.api.poses import Component, Coordinate
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.api.versions import BRANCH_PATTERN, LINE_PATTERN, wanted_version
from teachpath.editing import check_editable
from teachpath.errors import UnusableInput
from teachpath.io.store.store import Store
from teachpath.io.store.versions import Edit
from teachpath.learning.adaptation.adapted_course import AdaptationModel
from teachpath.learning.adaptation.target import Target
from teachpath.records import Array, Job, LearnedPath, ObjectPose, Scene, Version
from teachpath.records.poses import SAME_PLACE, unit_quaternion

if TYPE_CHECKING:  # computed in another process
    from teachpath.learning.adaptation.adapt import AdaptedPath


class TargetPose(Body):
    """Where a path is to begin or to end, in the world."""

    position: tuple[Coordinate, Coordinate, Coordinate] = Field(description="x, y, z of its centre [m]")
    orientation: tuple[Component, Component, Component, Component] | None = Field(
        None, description="quaternion w, x, y, z, on a path that has learned orientations; left out: as learned"
    )


class NewAdaptation(Body):
    """Where the object lies and where it is to go."""

    start: TargetPose | None = Field(None, description="left out: where the object of the task's scene lies")
    goal: TargetPose | None = Field(None, description="left out: where the version ends")
    version: int | None = Field(None, description="to adapt; without it the newest on the main branch")
    branch: str = Field(
        "", max_length=64, pattern=BRANCH_PATTERN, description="to continue or to begin; empty: the branch of the base"
    )
    name: str = Field("adapted", max_length=80, pattern=LINE_PATTERN, description="what to call the new version")
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who asked for it")


@dataclass(frozen=True, eq=False)
class Adaptation:
    """A path that was adapted to another start and goal.

    Attributes:
        version: that was saved, or the base itself when it begins and ends there already.
        path: of that version.
        spread: two standard deviations [m] of a demonstration between these ends from the path, at 100 equal arc
            lengths.
        demonstrations: how many the shape was learned from.
        places: at how many different starts or goals these were shown.
        extrapolates: what is beyond the shown range; empty within it.
        note: how sure the adaptation is, in words.
        job: that certifies the version; its outcome is a plan.
    """

    version: Version
    path: LearnedPath
    spread: Array
    demonstrations: int
    places: int
    extrapolates: str
    note: str
    job: Job


UNCHANGED: Final[dict[str, Any]] = {
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
        responses={200: UNCHANGED | located(200, "the version")[200]}
        | located(201, "the version")
        | refusals(409, 507),
        dependencies=TEACH,
    )
    def adapt_path(path: str, wanted: NewAdaptation, sender: Sender) -> Response:
        """Adapt a path to another start and goal of the object: a new version, and a job that certifies it.

        The shape is learned from all demonstrations of the run that do the task in the same way, wherever they did it.
        The version takes the object where it begins; its plans start when the object lies there (PUT
        /scenes/{scene}/object).
        """
        base = wanted_version(store, path, wanted.version)
        run = store.run(base.run)
        scene = parts.objects.scene(store.task(run.task).scene)
        target = _target(base, scene, wanted)
        shown = shown_for(parts, run, base)
        adapted = parts.assessor.adapt(base, shown, target)
        author = signed(sender, wanted.author)
        saved = _saved(store, base, wanted, author, adapted, _object_pose(scene, target))
        order = {"path": path, "version": saved.number}
        job = parts.jobs.submit(run.task, "plan", order, who=sender.name)
        answer = Adaptation(
            saved,
            versions.get(path, saved.number)[1],
            adapted.spread,
            adapted.demonstrations,
            adapted.places,
            adapted.extrapolates,
            adapted.note,
            job,
        )
        location = f"/api/v1/paths/{path}/versions/{saved.number}"
        status = 200 if saved.number == base.version else 201
        return json_response(answer, status=status, headers={"Location": location})

    @router.get(
        "/paths/{path}/versions/{number}/adaptation-model", response_model=model_of(AdaptationModel), dependencies=VIEW
    )
    def get_adaptation_model(path: str, number: int) -> Response:
        """Return what a version between other ends is computed from, so that a page can draw it while it is dragged."""
        base = versions.get(path, number)[1]
        shown = shown_for(parts, store.run(base.run), base)
        return json_response(parts.assessor.adaptation_model(base, shown))

    return router


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
