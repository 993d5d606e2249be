"""Meshes on their way into scenes: a file is sent, and its convex hull or pieces come back."""

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
from teachpath.io.meshes import FILE_SUFFIXES, MAX_PIECES
from teachpath.offline.import_job import UPLOAD


class MeshHull(Body):
    """The convex hull or pieces of a mesh, as a shape of a scene takes them."""

    file: str = Field(description="its name")
    vertices: list[Point] = Field(description="three corners a triangle, counter-clockwise from outside, in its units")
    max_pieces: int = Field(1, description="most pieces that were asked for")
    pieces: list[int] = Field([], description="number of triangles of each convex piece; none: it is one hull")


def meshes_router(parts: Parts) -> APIRouter:
    """Return the route of meshes."""
    router = APIRouter(tags=["station"])
    transfers = parts.transfers

    @router.post("/meshes", openapi_extra={"requestBody": FILE_BODY}, responses=refusals(507), dependencies=TEACH)
    async def read_mesh(
        request: Request,
        sender: Sender,
        name: Annotated[
            str,
            Query(
                description=f"of the file; its end says what it is: {', '.join(FILE_SUFFIXES)}",
                min_length=1,
                max_length=200,
            ),
        ],
        max_pieces: Annotated[
            int, Query(description="most convex pieces that it is cut into; 1: its hull", ge=1, le=MAX_PIECES)
        ] = 1,
    ) -> MeshHull:
        """Return the convex hull of a mesh file sent as the request's body, or its convex pieces; nothing is kept.

        Several pieces leave free what a hull would fill, as the inside of a bin; they are searched for some seconds.
        A shape of kind `mesh` takes all fields of the answer as they are; its `size` is the factor from the file's
        units to metres.
        """
        from teachpath.robot.scene_preparation import read_mesh as hull_of  # with the libraries of planning

        folder = await run_in_threadpool(transfers.make, submitter_of(request, sender))
        try:
            await receive_file(request, folder / UPLOAD, name)
            mesh = await run_in_threadpool(parts.mesh_reader.call, hull_of, folder / UPLOAD, name, max_pieces)
        finally:
            await run_in_threadpool(transfers.remove, folder.name)
        return MeshHull(file=name, vertices=list(mesh.vertices), max_pieces=max_pieces, pieces=list(mesh.pieces))

    return router
