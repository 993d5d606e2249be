"""Signing in at a provider of OpenID Connect: where the page sends a person, and what it does with the answer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Request, Response
from pydantic import Field

from teachpath.access.provider_sign_in import LIFE, Answer, ProviderSignIn
from teachpath.api.access import NO_CAPABILITY
from teachpath.api.access_routes import Identity, identity_of
from teachpath.api.audit import CLAIMED_NAME_ATTRIBUTE
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.session_cookie import SIGN_IN, clear_cookie, read_cookie, require_private_line, set_cookie
from teachpath.api.strict_requests import Body
from teachpath.errors import NotAllowed, UnusableInput

MAX_ASKING: Final = 4  # threads that wait for the provider


class Page(Body):
    """The page to which a person comes back."""

    path: str = Field(
        max_length=200, pattern=r"^/[a-zA-Z0-9._~/-]*$", description="of the page's address, e.g. / or /robot/"
    )


class ProviderAnswer(Body):
    """What the provider has sent the browser back with, as the page's address has it."""

    code: str = Field(min_length=1, max_length=4096, description="of the provider")
    state: str = Field(max_length=256, description="of the sign-in, as it was sent to the provider")
    iss: str = Field("", max_length=1024, description="issuer, where the provider names it (RFC 9207)")


@dataclass(frozen=True, slots=True)
class SignInAddress:
    """Where a person signs in.

    Attributes:
        address: of the provider, with what it needs to know.
    """

    address: str


def provider_router(parts: Parts) -> APIRouter:
    """Return the routes of signing in at a provider."""
    router = APIRouter(tags=["access"])
    access, asking = parts.access, CapacityLimiter(MAX_ASKING)

    @router.post("/session/authorization", responses=refusals(503), dependencies=NO_CAPABILITY)
    async def begin_sign_in(page: Page, request: Request, response: Response) -> SignInAddress:
        """Begin to sign in at the provider: the answer says where, and sets a cookie by which the browser is known."""
        provider = _provider(access.provider, request)
        origin = request.headers.get("origin", "")  # that it is this station's own was seen before
        if not origin:
            raise NotAllowed("people sign in on this station's page; programs send a token instead")
        begin = partial(provider.begin, origin + page.path, _address(request))
        address, secret = await run_sync(begin, limiter=asking)
        set_cookie(request, response, secret, seconds=LIFE, kind=SIGN_IN)
        return SignInAddress(address)

    @router.post("/session/code", responses=refusals(401, 409, 503, 507), dependencies=NO_CAPABILITY)
    async def finish_sign_in(answer: ProviderAnswer, request: Request, response: Response) -> Identity:
        """Sign in with the answer of the provider; the answer sets the cookie of a session."""
        provider = _provider(access.provider, request)
        given = Answer(answer.code, answer.state, answer.iss)
        finish = partial(provider.finish, given, read_cookie(request, SIGN_IN))
        secret, subject = await run_sync(finish, limiter=asking)
        request.scope[CLAIMED_NAME_ATTRIBUTE] = subject.name
        if former := read_cookie(request):
            await run_sync(access.sessions.sign_out, former)
        clear_cookie(request, response, SIGN_IN)
        set_cookie(request, response, secret, seconds=parts.settings.auth.session_length)
        return identity_of(access, subject)

    return router


def _provider(provider: ProviderSignIn | None, request: Request) -> ProviderSignIn:
    if provider is None:
        raise UnusableInput("nobody signs in at a provider here (auth.mode is not oidc)")
    require_private_line(request)
    return provider


def _address(request: Request) -> str:
    return request.client.host if request.client else ""
