"""Adaptation of a path to an object and a goal that lie elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np
from fastapi import APIRouter, Response
from pydantic import Field

from teachpath.api.answers import json_response, model_of
from teachpath.api.parts import Parts
from teachpath.api.strict_requests import Body
from teachpath.api.versions import BRANCH_PATTERN, LINE_PATTERN
from teachpath.editing import MAX_COORDINATE, check_editable
from teachpath.errors import UnusableInput
from teachpath.io.store.versions import Edit
from teachpath.learning.adaptation.adapt import AdaptedPath, adapt
from teachpath.learning.adaptation.target import Target
from teachpath.learning.settings import settings_of_run
from teachpath.learning.summary import fingerprint
from teachpath.records import Array, Job, LearnedPath, Trajectory, Version

MAX_NORM_ERROR: Final = 0.01  # of a quaternion that is brought to unit length

Coordinate = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, allow_inf_nan=False)]
Component = Annotated[float, Field(allow_inf_nan=False)]


class ObjectPose(Body):
    """Where the object is, or is to be, in the world."""

    position: tuple[Coordinate, Coordinate, Coordinate] = Field(description="x, y, z of its centre [m]")
    orientation: tuple[Component, Component, Component, Component] | None = Field(
        None, description="quaternion w, x, y, z, on a path that has learned orientations; left out: as learned"
    )


class NewAdaptation(Body):
    """Where the object lies and where it is to go."""

    start: ObjectPose
    goal: ObjectPose
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
        version: that was saved.
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


def adaptations_router(parts: Parts) -> APIRouter:
    """Return the route of adaptations."""
    router = APIRouter(tags=["versions"])
    store, versions = parts.store, parts.store.versions

    @router.post("/paths/{path}/adaptations", status_code=201, response_model=model_of(Adaptation))
    def adapt_path(path: str, wanted: NewAdaptation, response: Response) -> Response:
        """Adapt a path to another start and goal of the object: a new version, and a job that certifies it.

        The shape is learned from all demonstrations of the run that do the task in the same way, wherever they did it.
        The path of the same ends stays as it is, which is refused as no change.
        """
        base = store.path(path) if wanted.version is None else versions.get(path, wanted.version)[1]
        adapted, task = _adapted(parts, base, _target(wanted))
        curve = check_editable(adapted.curve)
        edit = Edit(base.version, wanted.branch.strip(), wanted.name.strip(), wanted.author.strip(), adapted.note)
        saved = versions.save(path, curve, edit, orientation=adapted.orientation)
        job = parts.jobs.submit(task, "plan", {"path": path, "version": saved.number})
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
        return json_response(answer, status=201, headers={"Location": location})

    return router


def _adapted(parts: Parts, base: LearnedPath, target: Target) -> tuple[AdaptedPath, str]:
    """Adapt a version by the selected demonstrations of its run, and return the task too."""
    run = parts.store.run(base.run)
    clusters = {cluster.index: cluster for cluster in run.learned.clusters}
    own = {score.demonstration for score in clusters[base.cluster].scores if score.selected}
    selected = {s.demonstration for cluster in clusters.values() for s in cluster.scores if s.selected}
    members: list[Trajectory] = []
    others: list[Trajectory] = []
    for demonstration in parts.store.demonstrations(run.task):
        if demonstration.is_usable and demonstration.id in selected:
            trajectory = parts.trajectory(demonstration)
            if fingerprint(trajectory) == run.learned.inputs.get(demonstration.id):
                (members if demonstration.id in own else others).append(trajectory)
    if not members:
        raise UnusableInput(
            f"the demonstrations that path {base.id} was learned from have changed or are gone; learn the task anew"
        )
    learned = parts.store.versions.get(base.id, 1)[1].curve
    return adapt(base, learned, members, others, target, settings_of_run(run.learned.settings)), run.task


def _target(wanted: NewAdaptation) -> Target:
    (start, turned), (goal, turned_goal) = _pose(wanted.start, "start"), _pose(wanted.goal, "goal")
    return Target(start, goal, turned, turned_goal)


def _pose(pose: ObjectPose, place: str) -> tuple[Array, Array | None]:
    position = np.array(pose.position)
    if pose.orientation is None:
        return position, None
    norm = float(np.linalg.norm(pose.orientation))
    if not abs(norm - 1) <= MAX_NORM_ERROR:
        raise UnusableInput(
            f"{place}.orientation has length {norm:.4g}; a quaternion of a rotation has length 1 within "
            f"{MAX_NORM_ERROR:g}: divide it by its length"
        )
    return position, np.array(pose.orientation) / norm
