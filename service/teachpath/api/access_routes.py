"""Who may do what: who you are here, your session, and the tokens of programs."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import Final, Literal

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Request, Response
from pydantic import Field

from teachpath.access.access import Access
from teachpath.access.tokens import new_token
from teachpath.api.access import ADMINISTER, NO_CAPABILITY, Sender
from teachpath.api.audit import CLAIMED_NAME_ATTRIBUTE
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.session_cookie import clear_cookie, read_cookie, require_private_line, set_cookie
from teachpath.api.strict_requests import Body, Roles
from teachpath.errors import UnusableInput
from teachpath.records import AccessToken, Capability, Subject
from teachpath_proto.keys import is_name, name_refusal

MAX_HASHING: Final = 2  # passwords that are checked at a time, of 64 MiB each


class Credentials(Body):
    """Who wants to sign in."""

    name: str = Field(max_length=64, description="of the person")
    password: str = Field(max_length=1024, description="of the person")


class NewToken(Body):
    """A token to make."""

    name: str = Field(description="of the program; the journal has it")
    roles: Roles = Field(min_length=1, max_length=len(Capability), description="what it may do")
    days: float = Field(90.0, gt=0.0, le=3650.0, description="until it expires")


@dataclass(frozen=True, slots=True)
class Identity:
    """Who you are at a station.

    Attributes:
        mode: how it tells who asks; `none`: it does not ask.
        name: yours; empty where it does not ask.
        capabilities: what you may do.
        provider: at which people sign in; empty: with a password.
        groups: yours, as the proxy tells them where `mode` is `proxy`.
    """

    mode: Literal["none", "token", "oidc", "proxy"]
    name: str
    capabilities: tuple[Capability, ...]
    provider: str = ""
    groups: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ListedToken:
    """A token, without itself; times in nanoseconds since the Unix epoch, 0: never.

    Attributes:
        name: of the program.
        roles: what it may do.
        created_ns: when it was made [ns since the Unix epoch].
        expires_ns: from when on it holds no longer [ns since the Unix epoch].
        used_ns: when it was last used, to the minute [ns since the Unix epoch]; 0: never.
        revoked_ns: when it was revoked [ns since the Unix epoch]; 0: it was not.
    """

    name: str
    roles: tuple[Capability, ...]
    created_ns: int
    expires_ns: int
    used_ns: int
    revoked_ns: int


@dataclass(frozen=True, slots=True)
class MadeToken:
    """A token that was just made; it is told this once.

    Attributes:
        token: for the header Authorization, as `Bearer TOKEN`.
        name: of the program.
        roles: what it may do.
        expires_ns: from when on it holds no longer [ns since the Unix epoch].
    """

    token: str
    name: str
    roles: tuple[Capability, ...]
    expires_ns: int


def access_router(parts: Parts) -> APIRouter:
    """Return the routes of who may do what."""
    router = APIRouter(tags=["access"])
    access, tokens, hashing = parts.access, parts.store.access_tokens, CapacityLimiter(MAX_HASHING)

    @router.get("/identity", dependencies=NO_CAPABILITY)
    async def get_identity(sender: Sender) -> Identity:
        """Say who you are here, and what you may do."""
        return identity_of(access, sender)

    @router.post("/session", responses=refusals(401, 507), dependencies=NO_CAPABILITY)
    async def sign_in(wanted: Credentials, request: Request, response: Response) -> Identity:
        """Sign in with name and password; the answer sets the cookie of a session."""
        request.scope[CLAIMED_NAME_ATTRIBUTE] = wanted.name
        require_private_line(request)
        if access.mode == "none":
            raise UnusableInput(
                "this station asks nobody who he is (auth.mode is none); there is nothing to sign in to"
            )
        if access.mode == "proxy":
            raise UnusableInput("the proxy asks who somebody is (auth.mode is proxy); sign in there")
        if access.provider:
            raise UnusableInput(f"people sign in at {access.provider.name} here (auth.mode is oidc), on the page")
        address = request.client.host if request.client else ""
        checked = partial(access.sessions.sign_in, wanted.name, wanted.password, address)
        secret, subject = await run_sync(checked, limiter=hashing)
        if former := read_cookie(request):
            await run_sync(access.sessions.sign_out, former)
        set_cookie(request, response, secret, seconds=parts.settings.auth.session_length)
        return identity_of(access, subject)

    @router.delete("/session", status_code=204, dependencies=NO_CAPABILITY)
    def sign_out(request: Request, response: Response) -> None:
        """Sign out: the session and every WebSocket that was opened in it end."""
        if session := read_cookie(request):
            access.sessions.sign_out(session)
            access.refresh()
        clear_cookie(request, response)

    @router.get("/tokens", dependencies=ADMINISTER)
    def list_tokens() -> list[ListedToken]:
        """List the tokens, oldest first; revoked and expired ones stay listed."""
        return [_listed(token) for token in tokens.all()]

    @router.post("/tokens", status_code=201, responses=refusals(409, 507), dependencies=ADMINISTER)
    def make_token(new: NewToken) -> MadeToken:
        """Make a token for a program and return it: it is kept as a hash, and never told again."""
        if not is_name(new.name):
            raise UnusableInput(name_refusal("token", new.name))
        token, kept = new_token(new.name, tuple(new.roles), now_ns=time.time_ns(), days=new.days)
        tokens.add(kept)
        access.refresh()
        return MadeToken(token, kept.name, kept.roles, kept.expires_ns)

    @router.delete("/tokens/{name}", responses=refusals(507), dependencies=ADMINISTER)
    def revoke_token(name: str) -> ListedToken:
        """Revoke the token of a name, and end every WebSocket that was opened with it."""
        revoked = tokens.revoke(name, time.time_ns())
        access.refresh()
        return _listed(revoked)

    return router


def identity_of(access: Access, subject: Subject) -> Identity:
    """Return who a subject is at a station."""
    capabilities = tuple(c for c in Capability if c in subject.capabilities)
    provider = access.provider.name if access.provider else ""
    return Identity(access.mode, subject.name, capabilities, provider, subject.groups)


def _listed(token: AccessToken) -> ListedToken:
    return ListedToken(token.name, token.roles, token.created_ns, token.expires_ns, token.used_ns, token.revoked_ns)
