"""Control: the lease that allows to move the arm, the journal of commands, and revoked certificates."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from pydantic import Field

from teachpath.api.access import OPERATE, VIEW, Sender, Who, signed
from teachpath.api.answers import model_of
from teachpath.api.executions import Token
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.records import JournalEntry, Lease, LeaseRequest, Subject
from teachpath_proto.control import LeaseAction


class LeaseClaim(Body):
    """A request for control of the arm."""

    name: str = Field(min_length=1, max_length=64, description="shown to everybody; beside the name of a token")
    seconds: float = Field(5.0, ge=0.5, le=60.0, description="between two beats at most; then the lease lapses")
    hold_when_lost: bool = Field(False, description="hold a moving arm on its path when the beats stop")


class Revocation(Body):
    """Why a certificate is revoked."""

    reason: str = Field(min_length=1, max_length=500, description="in words, for the journal")


def control_router(parts: Parts) -> APIRouter:
    """Return the routes of control."""
    router = APIRouter(tags=["control"])
    executions, store = parts.executions, parts.store

    @router.get("/lease", dependencies=VIEW)
    def get_lease() -> Lease:
        """Say who is in control. With an empty `holder` everybody may command."""
        return executions.request_lease(LeaseRequest(LeaseAction.LOOK))

    @router.post("/lease", status_code=201, responses=refusals(409), dependencies=OPERATE)
    def acquire_lease(claim: LeaseClaim, sender: Sender) -> Lease:
        """Take control, when nobody has it; send `token` as header Teachpath-Lease from now on, and beats in time."""
        return executions.request_lease(_request(LeaseAction.ACQUIRE, claim, sender))

    @router.post("/lease/ask", responses=refusals(409), dependencies=OPERATE)
    def ask_for_lease(claim: LeaseClaim, sender: Sender) -> Lease:
        """Ask the holder for control; everybody sees who asks.

        Send beats with `token`: the answer says who holds control. A holder who says nothing loses it after
        `granted_in` seconds; one who keeps it ends the request, and the next beat is refused.
        """
        return executions.request_lease(_request(LeaseAction.ASK, claim, sender))

    @router.post("/lease/{action}", responses=refusals(409), dependencies=OPERATE)
    def act_on_lease(action: Literal["beat", "release", "keep"], lease: Token) -> Lease:
        """Beat (still here), release control or the request for it, or keep control when somebody asks."""
        return executions.request_lease(LeaseRequest(LeaseAction(action), token=lease))

    @router.get("/journal", response_model=model_of(list[JournalEntry]), dependencies=VIEW)
    def list_journal(
        page: WantedPage, execution: Annotated[str, Query(description="id of one; empty: all")] = ""
    ) -> Response:
        """List who did what to the arm, and how it was answered, newest first."""
        return page.answer(store.lists.journal(execution, page.wanted))

    @router.post("/plans/{plan}/revoke", status_code=204, responses=refusals(409, 507), dependencies=OPERATE)
    def revoke_plan(plan: str, revocation: Revocation, who: Who) -> None:
        """Take back a plan's certificate: it never starts again, and an arm that follows it is held for good."""
        executions.revoke(plan, reason=revocation.reason, who=who)

    return router


def _request(action: LeaseAction, claim: LeaseClaim, sender: Subject) -> LeaseRequest:
    name = signed(sender, claim.name)
    return LeaseRequest(action, name, seconds=claim.seconds, hold_when_lost=claim.hold_when_lost)
