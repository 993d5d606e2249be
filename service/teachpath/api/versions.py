"""The versions of a learned path: list, read, compare, and save an edited curve as a new one."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi import APIRouter, Response
from pydantic import Field

from teachpath.api.access import TEACH, VIEW, Sender, signed
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.curves import CurveBody
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.editing import difference
from teachpath.io.store.store import Store
from teachpath.io.store.versions import Edit
from teachpath.records import Difference, LearnedPath, Version

LINE_PATTERN = r"^[^\x00-\x1f\x7f]*$"  # one line
BRANCH_PATTERN = r"^([^\W_][\w .-]*)?$"


class NewVersion(Body):
    """An edited curve to save."""

    base: int = Field(ge=1, description="number of the version that was edited")
    curve: CurveBody = Field(description="as it was edited")
    branch: str = Field(
        "", max_length=64, pattern=BRANCH_PATTERN, description="to continue or to begin; empty: the branch of the base"
    )
    name: str = Field("", max_length=80, pattern=LINE_PATTERN, description="what to call it")
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who edited it")
    note: str = Field("", max_length=2000, description="why")


@dataclass(frozen=True, eq=False)
class SavedVersion:
    """A version of a learned path, and the path itself.

    Attributes:
        version: who saved what, and from which one.
        path: the learned path as it is in this version.
    """

    version: Version
    path: LearnedPath


def versions_router(parts: Parts) -> APIRouter:
    """Return the routes of versions."""
    router = APIRouter(tags=["versions"])
    versions = parts.store.versions

    @router.get("/paths/{path}/versions", response_model=model_of(list[Version]), dependencies=VIEW)
    def list_path_versions(path: str, page: WantedPage) -> Response:
        """List the versions of a path over all its branches, oldest first; the first is the one that was learned."""
        return page.answer(parts.store.lists.versions(path, page.wanted))

    @router.get("/paths/{path}/versions/{number}", response_model=model_of(SavedVersion), dependencies=VIEW)
    def get_version(path: str, number: int) -> Response:
        """Return one version and its curve."""
        return json_response(SavedVersion(*versions.get(path, number)))

    @router.post(
        "/paths/{path}/versions",
        status_code=201,
        responses=refusals(409, 507) | located(201, "the version"),
        dependencies=TEACH,
    )
    def save_version(path: str, new: NewVersion, sender: Sender, response: Response) -> Version:
        """Save an edited curve as a new version; none is ever saved over another.

        When somebody has saved a newer version on the branch meanwhile, nothing is saved: the answer is 409 with that
        version in `newer`. Save on a branch of another name, or edit the newer version.
        """
        edit = Edit(new.base, new.branch.strip(), new.name.strip(), signed(sender, new.author), new.note)
        base = parts.store.path(path)
        with named_in_body("base"):
            saved = versions.save(base.id, new.curve.curve(), edit)
        response.headers["Location"] = f"/api/v1/paths/{path}/versions/{saved.number}"
        return saved

    @router.get("/paths/{path}/versions/{first}/difference/{second}", dependencies=VIEW)
    def compare_versions(path: str, first: int, second: int) -> Difference:
        """Say how far the second of two versions lies from the first, and which control points were moved."""
        return difference(versions.get(path, first)[1].curve, versions.get(path, second)[1].curve)

    return router


def wanted_version(store: Store, path: str, version: int | None) -> LearnedPath:
    """Return the version of a path that a body names; when it names none, the newest on the main branch.

    Raises:
        NotFound: no such path.
        UnusableInput: the path has no such version.
    """
    newest = store.path(path)
    if version is None:
        return newest
    with named_in_body("version"):
        return store.versions.get(path, version)[1]
