"""What every route declares: the capability that it needs. A request without it is refused before anything is done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Final

from fastapi import Depends, Header, Security, params
from fastapi.openapi.models import HTTPBearer as BearerModel
from fastapi.security import SecurityScopes
from fastapi.security.base import SecurityBase
from starlette.requests import HTTPConnection, Request

from teachpath.access.access import REFUSED_SUBJECT, Access
from teachpath.access.proxy_people import FORWARDED_USER, NOT_FORWARDED, Forwarded
from teachpath.api.middleware import SAFE_METHODS
from teachpath.api.session_cookie import read_cookie
from teachpath.errors import NotAllowed, NotSignedIn
from teachpath.records import Capability, Subject

SUBJECT: Final = "teachpath.subject"  # where the scope of a connection has who sends it
MAX_HEADER_LENGTH: Final = 64  # characters of a name or a token of control
MAX_WHO_LENGTH: Final = 64  # characters of a name in the journal
Declaration = Sequence[params.Depends]


class _Bearer(SecurityBase):
    """Who sends a request or opens a WebSocket, by the header Authorization; described as a security scheme."""

    model = BearerModel(
        scheme="bearer", description="A token of `teachpath token create`; not asked for where auth.mode is none."
    )
    scheme_name = "token"

    async def __call__(self, connection: HTTPConnection) -> list[str]:
        return connection.headers.getlist("authorization")


_bearer: Final = _Bearer()


async def authorize(
    connection: HTTPConnection, needed: SecurityScopes, authorization: Annotated[list[str], Security(_bearer)]
) -> None:
    """Let a connection pass whose subject has a capability.

    Raises:
        NotSignedIn: nobody knows who it is.
        NotAllowed: the subject lacks the capability.
    """
    access: Access = connection.app.state.access
    session = _session(connection, access)
    subject = connection.scope[SUBJECT] = access.subject(authorization, session, _forwarded(connection, access))
    if session:
        _require_origin(connection)
    if lacking := [one for one in map(Capability, needed.scopes) if one not in subject.capabilities]:
        raise NotAllowed(access.refusal(subject, lacking))


async def require_access(request: Request) -> None:
    """Check what the route of a request needs, where that has not come to it yet: a stranger learns nothing of faults.

    Raises:
        NotSignedIn: nobody knows who it is.
        NotAllowed: the subject lacks the capability.
    """
    for declared in getattr(request.scope.get("route"), "dependencies", ()):
        if isinstance(declared, params.Security) and declared.dependency is authorize:
            await authorize(request, SecurityScopes(list(declared.scopes or ())), await _bearer(request))


async def let_pass(connection: HTTPConnection) -> None:
    """Let everybody pass; whoever shows something that is known has a name all the same."""
    connection.scope[SUBJECT] = identify(connection, connection.app.state.access)


def identify(connection: HTTPConnection, access: Access) -> Subject:
    """Return who sends a request or opens a WebSocket, whatever it may do; a stranger where nobody knows."""
    try:
        authorization = connection.headers.getlist("authorization")
        session = _session(connection, access)
        return access.subject(authorization, session, _forwarded(connection, access))
    except NotSignedIn:
        return REFUSED_SUBJECT


def _session(connection: HTTPConnection, access: Access) -> str:
    """Return the secret of the session of a request; empty where it has none, or shows a token."""
    if not access.has_sessions or "authorization" in connection.headers:
        return ""
    return read_cookie(connection)


def _forwarded(connection: HTTPConnection, access: Access) -> Forwarded:
    """Return whom a proxy brings; one that adds its word to what a client has sent says nothing."""
    if access.proxy is None:
        return NOT_FORWARDED
    said = []
    for name in (FORWARDED_USER, access.proxy.header):
        values = connection.headers.getlist(name)
        if len(values) > 1:
            raise NotSignedIn(f"the proxy hands on {len(values)} headers {name}; let it set one in their place")
        said.append(values[0] if values else "")
    return Forwarded(*said)


def _require_origin(connection: HTTPConnection) -> None:
    """Refuse what a cookie came with by itself: browsers name the page that sends an order or opens a WebSocket."""
    method = connection.scope.get("method")  # a WebSocket has none
    if method not in SAFE_METHODS and "origin" not in connection.headers:
        raise NotAllowed("an order in a session comes from this station's page; programs send a token instead")


def _needs(capability: Capability) -> Declaration:
    return [Security(authorize, scopes=[capability.value])]


# What a route says in its decorator: dependencies=VIEW.
VIEW: Final = _needs(Capability.VIEW)
DEMONSTRATE: Final = _needs(Capability.DEMONSTRATE)
TEACH: Final = _needs(Capability.TEACH)
OPERATE: Final = _needs(Capability.OPERATE)
ADMINISTER: Final = _needs(Capability.ADMINISTER)
NO_CAPABILITY: Final[Declaration] = [Depends(let_pass)]


async def subject_of(connection: HTTPConnection) -> Subject:
    """Return who sends a request."""
    subject: Subject = connection.scope[SUBJECT]
    return subject


async def operator_of(
    sender: Sender,
    label: Annotated[
        str,
        Header(
            alias="Teachpath-Operator",
            max_length=MAX_HEADER_LENGTH,
            description="your name, for the journal; beside that of your token, where the station asks for one",
        ),
    ] = "",
) -> str:
    """Return who orders something, as the journal says it."""
    return signed(sender, label)


Sender = Annotated[Subject, Depends(subject_of)]
Who = Annotated[str, Depends(operator_of)]


def signed(subject: Subject, label: str, length: int = MAX_WHO_LENGTH) -> str:
    """Return the authenticated name of a subject, and beside it what it calls itself; that alone where nobody asks."""
    label = label.strip()
    if not subject.name:
        return label
    return (f"{subject.name} ({label})" if label and label != subject.name else subject.name)[:length]
