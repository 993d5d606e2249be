"""The audit log over REST, and the middleware by which every order and every refusal comes into it."""

from __future__ import annotations

import json
from collections import OrderedDict
from typing import Final

from fastapi import APIRouter, Response
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.access.access import REFUSED_SUBJECT
from teachpath.access.audit import Audit
from teachpath.access.proxy_people import listed
from teachpath.api.access import ADMINISTER, SUBJECT, signed
from teachpath.api.answers import model_of
from teachpath.api.middleware import SAFE_METHODS
from teachpath.api.pages import WantedPage
from teachpath.api.parts import Parts
from teachpath.api.request_numbers import ROUTINE
from teachpath.records import AuditEntry, Capability, Subject

CLAIMED_NAME_ATTRIBUTE: Final = (
    "teachpath.claimed"  # where the scope of a request has whom somebody says to be who signs in
)
NOTED_ATTRIBUTE: Final = "teachpath.noted"  # where it has what is written in the place of a body that holds a password
SECRET: Final = ("/session", "/people")  # parts of paths whose bodies hold passwords
REFUSAL_CODES: Final = (401, 403, 408, 413, 429)  # answers that are written whatever was asked for
MAX_BODY: Final = 1000  # bytes of an order that are written
MAX_KNOWN: Final = 10_000  # people of a proxy of whom it is known what was written; beyond, the oldest is forgotten


class AuditRequests:
    """Writes who ordered what, from where, and how it was answered; a middleware around all others.

    Where a proxy tells the groups of people, it writes what each may do, and again when that has changed.
    """

    def __init__(self, app: ASGIApp, *, audit: Audit, is_proxied: bool = False) -> None:
        self._app, self._audit = app, audit
        self._arrivals = _Arrivals(audit) if is_proxied else None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        request = _Request(scope, receive, send)
        try:
            await self._app(scope, request.receive, request.send)
        finally:
            if self._arrivals:
                self._arrivals.note(scope.get(SUBJECT), request.source)
            if request.is_to_be_written:
                action = request.action
                self._audit.note(request.who, request.source, action, request.answer, is_refusal=request.is_refused)


class _Arrivals:
    """Writes whom a proxy brings and what he may do: there is no sign-in at the station that would be written."""

    def __init__(self, audit: Audit) -> None:
        self._audit = audit
        self._known: OrderedDict[str, Subject] = OrderedDict()

    def note(self, subject: Subject | None, source: str) -> None:
        if not subject or not subject.name or subject is REFUSED_SUBJECT or self._known.get(subject.name) == subject:
            return
        self._known[subject.name] = subject
        while len(self._known) > MAX_KNOWN:
            self._known.popitem(last=False)
        may = ", ".join(one for one in Capability if one in subject.capabilities) or "do nothing"
        self._audit.note(
            subject.name, source, f"comes through the proxy; groups: {listed(subject.groups)}", f"may {may}"
        )


class _Request:
    """A request, with the beginnings of its body and of its answer."""

    def __init__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self._scope, self._receive, self._send = scope, receive, send
        headers = Headers(scope=scope)
        self._label = headers.get("teachpath-operator", "")
        self._is_shown = headers.get("content-type", "").startswith("application/json") and not any(
            part in scope["path"] for part in SECRET
        )
        self._status = 0
        self._body = self._refusal = b""

    async def receive(self) -> Message:
        message = await self._receive()
        if self._is_shown and len(self._body) < MAX_BODY:
            self._body += message.get("body", b"")[:MAX_BODY]
        return message

    async def send(self, message: Message) -> None:
        if message["type"] in ("http.response.start", "websocket.http.response.start"):
            self._status = message["status"]
        elif self.is_refused and len(self._refusal) < MAX_BODY:
            self._refusal += message.get("body", b"")
        await self._send(message)

    @property
    def is_refused(self) -> bool:
        return self._status >= 400

    @property
    def is_to_be_written(self) -> bool:
        method = self._scope.get("method", "GET")
        return self._status in REFUSAL_CODES or (
            method not in SAFE_METHODS and self._status > 0 and not self._scope["path"].endswith(ROUTINE)
        )

    @property
    def who(self) -> str:
        subject: Subject | None = self._scope.get(SUBJECT)
        if claimed := self._scope.get(CLAIMED_NAME_ATTRIBUTE):
            return f"who signs in as {claimed}"
        return signed(subject, self._label) if subject else self._label

    @property
    def source(self) -> str:
        client = self._scope.get("client")
        return client[0] if client else ""

    @property
    def action(self) -> str:
        words = f"{self._scope.get('method', 'WS')} {self._scope['path']}"
        noted = self._scope.get(NOTED_ATTRIBUTE) or self._body[:MAX_BODY].decode(errors="replace")
        return f"{words} {noted}".strip()

    @property
    def answer(self) -> str:
        if not self.is_refused:
            return str(self._status)
        try:
            return f"{self._status}: {json.loads(self._refusal)['detail']}"
        except (ValueError, KeyError, TypeError):
            return str(self._status)


def audit_router(parts: Parts) -> APIRouter:
    """Return the route of the audit log."""
    router = APIRouter(tags=["access"])

    @router.get("/audit", response_model=model_of(list[AuditEntry]), dependencies=ADMINISTER)
    def list_audit(page: WantedPage) -> Response:
        """List who did what at the station, from where, and how it was answered, newest first.

        Every entry has the hash of the one before; `teachpath audit verify` checks them all.
        """
        return page.answer(parts.audit.log.page(page.wanted))

    return router
