"""Demonstrations: read and annotate them, get their trajectories and recordings."""

from __future__ import annotations

from typing import Annotated, Literal

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse
from pydantic import Field, Strict

from teachpath.api.access import DEMONSTRATE, VIEW, Sender
from teachpath.api.answers import MCAP, files, model_of
from teachpath.api.parts import MAX_READERS, Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.recorder.recording_work import encode_trajectory
from teachpath.records import Amendment, Demonstration, Trajectory


class DemonstrationChanges(Body):
    """What an operator changes of a demonstration; a field that is left out stays as it is."""

    mark: Literal["", "good", "bad"] | None = Field(None, description="good, bad, or empty for none")
    discarded: bool | None = Field(None, description="discarded ones are kept, but not learned from")
    trim: Annotated[tuple[int, int], Strict(False)] | None = Field(
        None, description="transport phase, samples[begin:end]; [0, 0] brings back the recorder's own cut"
    )


def demonstrations_router(parts: Parts) -> APIRouter:
    """Return the routes of single demonstrations."""
    router = APIRouter(tags=["tasks"])
    store = parts.store
    readers = CapacityLimiter(MAX_READERS)

    @router.get("/demonstrations/{demonstration}", dependencies=VIEW)
    def get_demonstration(demonstration: str) -> Demonstration:
        """Return one demonstration."""
        return store.demonstration(demonstration)

    @router.patch("/demonstrations/{demonstration}", responses=refusals(409, 507), dependencies=DEMONSTRATE)
    def amend_demonstration(demonstration: str, changes: DemonstrationChanges, sender: Sender) -> Demonstration:
        """Mark, discard, restore or trim a demonstration; its recording and the recorder's own cut stay."""
        amendment = Amendment(mark=changes.mark, discarded=changes.discarded, trim=changes.trim)
        return parts.recorder.annotations.amend(demonstration, amendment, who=sender.name)

    @router.get("/demonstrations/{demonstration}/trajectory", response_model=model_of(Trajectory), dependencies=VIEW)
    async def get_trajectory(
        demonstration: str,
        most: Annotated[int, Query(ge=2, le=100_000, description="points; further ones are left out evenly")] = 100_000,
        decimals: Annotated[
            int | None, Query(ge=4, le=15, description="of every number, as much as is drawn; null: as it was measured")
        ] = None,
    ) -> Response:
        """Return the object's trajectory in its transport phase: times [s], positions [m], orientations, world."""

        def encoded() -> bytes:
            row = store.demonstration(demonstration)
            carried = parts.recorder.annotations.carried(row)
            return parts.reader.call(encode_trajectory, store.recordings, row, carried, most, decimals)

        return Response(await run_sync(encoded, limiter=readers), media_type="application/json")

    @router.get(
        "/demonstrations/{demonstration}/recording",
        response_class=FileResponse,
        responses=files(MCAP),
        dependencies=VIEW,
    )
    def download_demonstration(demonstration: str) -> FileResponse:
        """Return the MCAP file with every sample."""
        row = store.demonstration(demonstration)
        store.recordings.content(row.recording, row.digest)  # so that a changed one is refused
        name = row.recording.rpartition("/")[2]
        return FileResponse(store.recordings.path(row.recording), media_type=MCAP, filename=name)

    return router
