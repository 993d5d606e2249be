"""The people of a station, for whoever administers it: list, add, give another password, remove."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Request, Response
from pydantic import Field

from teachpath.access.passwords import hash_password
from teachpath.api.access import ADMINISTER, Sender
from teachpath.api.access_routes import MAX_HASHING
from teachpath.api.audit import NOTED_ATTRIBUTE
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.session_cookie import require_private_line
from teachpath.api.strict_requests import Body, Roles
from teachpath.errors import Conflict, UnusableInput
from teachpath.records import Capability, Person, Session
from teachpath_proto.keys import is_name, name_refusal


class NewPassword(Body):
    """Another password."""

    password: str = Field(max_length=1024, description="of the person")


class NewPerson(NewPassword):
    """Somebody who may sign in."""

    name: str = Field(max_length=64, description="of the person; the journal has it")
    roles: Roles = Field(min_length=1, max_length=len(Capability), description="what the person may do")


@dataclass(frozen=True, slots=True)
class ListedPerson:
    """Somebody who may sign in, without the password.

    Attributes:
        name: of the person.
        roles: what the person may do.
        created_ns: when the person was added [ns since the Unix epoch].
        changed_ns: when the password was set [ns since the Unix epoch].
        sessions: that have not ended.
        used_ns: when something was asked in one of them last [ns since the Unix epoch]; 0: there is none.
    """

    name: str
    roles: tuple[Capability, ...]
    created_ns: int
    changed_ns: int
    sessions: int
    used_ns: int


def people_router(parts: Parts) -> APIRouter:
    """Return the routes of people."""
    router = APIRouter(tags=["access"])
    access, people, hashing = parts.access, parts.store.people, CapacityLimiter(MAX_HASHING)

    @router.get("/people", dependencies=ADMINISTER)
    def list_people() -> list[ListedPerson]:
        """List the people who may sign in, by name, and how many sessions each has."""
        sessions = people.sessions()
        return [_listed(person, sessions) for person in people.all()]

    @router.post("/people", status_code=201, responses=refusals(409, 507), dependencies=ADMINISTER)
    async def add_person(new: NewPerson, request: Request) -> ListedPerson:
        """Add somebody who may sign in; of the password a hash is kept."""
        request.scope[NOTED_ATTRIBUTE] = f"{new.name}, {' '.join(new.roles)}"
        require_private_line(request)
        if access.provider:
            raise Conflict(f"people are known by {access.provider.name} here (auth.mode is oidc): add them there")
        if not is_name(new.name):
            raise UnusableInput(name_refusal("person", new.name))
        kept = await run_sync(partial(hash_password, new.password, new.name), limiter=hashing)
        now = time.time_ns()
        person = Person(new.name, tuple(new.roles), kept, now, now)
        await run_sync(people.add, person)
        await run_sync(access.refresh)
        return _listed(person, [])

    @router.put("/people/{name}/password", status_code=204, responses=refusals(409, 507), dependencies=ADMINISTER)
    async def change_password(name: str, new: NewPassword, request: Request) -> Response:
        """Give a person another password; every session that was begun with the former one ends."""
        require_private_line(request)
        kept = await run_sync(partial(hash_password, new.password, name), limiter=hashing)
        await run_sync(people.change_password, name, kept, time.time_ns())
        await run_sync(access.refresh)
        return Response(status_code=204)

    @router.delete("/people/{name}", status_code=204, responses=refusals(409, 507), dependencies=ADMINISTER)
    def remove_person(name: str, sender: Sender) -> None:
        """Remove a person; every session ends, and every WebSocket that was opened in it."""
        if name == sender.name:
            raise Conflict(f"{name} would lock the door behind: somebody else removes you, or: teachpath person remove")
        people.remove(name)
        access.refresh()

    return router


def _listed(person: Person, sessions: list[Session]) -> ListedPerson:
    used = [session.used_ns for session in sessions if session.person == person.name]
    return ListedPerson(
        person.name, person.roles, person.created_ns, person.changed_ns, len(used), max(used, default=0)
    )
