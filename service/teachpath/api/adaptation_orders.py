"""The order of an adaptation, as its job keeps it, and the answer to it: the same one when it comes again."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from fastapi import Response

from teachpath.api.answers import json_response
from teachpath.io.documents import from_document
from teachpath.io.store.store import Store
from teachpath.jobs.idempotency import ORDER_KEY
from teachpath.records import Array, Job, LearnedPath, Version

if TYPE_CHECKING:  # computed in another process
    from teachpath.learning.adaptation.adapt import AdaptedPath

FINDINGS = "adaptation"  # in the request of the job: what the answer says beside version and job


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


@dataclass(frozen=True)
class Findings:
    """What is said of an adapted path; see `Adaptation`."""

    base: int
    spread: tuple[float, ...]
    demonstrations: int
    places: int
    extrapolates: str
    note: str


def order_of(saved: Version, ordered: dict[str, Any], adapted: AdaptedPath, base: int) -> dict[str, Any]:
    """Return the request of the job that certifies an adapted version of a path.

    Args:
        saved: the version.
        ordered: what the sender wants.
        adapted: the path.
        base: number of the version that was adapted.
    """
    spread, shown = tuple(map(float, adapted.spread)), (adapted.demonstrations, adapted.places)
    findings = Findings(base, spread, *shown, adapted.extrapolates, adapted.note)
    return {"path": saved.path, "version": saved.number, ORDER_KEY: ordered, FINDINGS: asdict(findings)}


def answer_of(store: Store, job: Job) -> Response:
    """Return the answer to an adaptation whose job this is."""
    request: dict[str, Any] = job.request
    path, number = request["path"], request["version"]
    found = from_document(Findings, request[FINDINGS])
    version, learned = store.versions.get(path, number)
    answer = Adaptation(
        version,
        learned,
        np.array(found.spread),
        found.demonstrations,
        found.places,
        found.extrapolates,
        found.note,
        job,
    )
    location = f"/api/v1/paths/{path}/versions/{number}"
    return json_response(answer, status=200 if number == found.base else 201, headers={"Location": location})
