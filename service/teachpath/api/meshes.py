"""Meshes on their way into scenes: a file is sent, and its convex hull comes back."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from teachpath.api.access import TEACH, Sender
from teachpath.api.imports import FILE_BODY, receive_file
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.scenes import Point
from teachpath.api.strict_requests import Body
from teachpath.api.work import submitter_of
from teachpath.offline.import_job import UPLOAD


class MeshHull(Body):
    """The convex hull of a mesh, as a shape of a scene takes it."""

    file: str = Field(description="its name")
    vertices: list[Point] = Field(description="three corners a triangle, counter-clockwise from outside, in its units")


def meshes_router(parts: Parts) -> APIRouter:
    """Return the route of meshes."""
    router = APIRouter(tags=["station"])
    transfers = parts.transfers

    @router.post("/meshes", openapi_extra={"requestBody": FILE_BODY}, responses=refusals(507), dependencies=TEACH)
    async def read_mesh(
        request: Request,
        sender: Sender,
        name: Annotated[
            str, Query(description="of the file; its end says what it is: .obj or .stl", min_length=1, max_length=200)
        ],
    ) -> MeshHull:
        """Return the convex hull of a mesh file sent as the request's body; nothing is kept.

        A shape of kind `mesh` takes `file` and `vertices` as they are; its `size` is the factor from the file's units
        to metres.
        """
        from teachpath.robot.scene_preparation import read_mesh as hull_of  # with the libraries of planning

        folder = await run_in_threadpool(transfers.make, submitter_of(request, sender))
        try:
            await receive_file(request, folder / UPLOAD, name)
            hull = await run_in_threadpool(parts.reader.call, hull_of, folder / UPLOAD, name)
        finally:
            await run_in_threadpool(transfers.remove, folder.name)
        return MeshHull(file=name, vertices=list(hull))

    return router
