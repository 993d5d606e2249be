"""Middleware of a station with a certificate: what comes by http is sent to https, but for a stop."""

from __future__ import annotations

from typing import Final

from starlette.datastructures import URL
from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from teachpath.api.middleware import SAFE_METHODS, is_stop
from teachpath.api.problems import refuse

API: Final = "/api/"
# What a device needs before it trusts the certificate, the files of that page, and probes of this machine.
HTTP_PATHS: Final = ("/authority", "/web/", "/api/v1/health/live", "/api/v1/health/ready")


class HttpsOnly:
    """Redirects readers to https, and refuses what comes by http to the API: a token would be readable on the way.

    A stop is never refused; what says nothing of the station's work is given by http, too.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request by https on, and answer others."""
        if scope["type"] not in ("http", "websocket") or scope["scheme"] in ("https", "wss") or _is_allowed(scope):
            await self._app(scope, receive, send)
            return
        secure = URL(scope=scope).replace(scheme="https")
        if scope["type"] == "http" and scope["method"] in SAFE_METHODS and not scope["path"].startswith(API):
            await RedirectResponse(str(secure), 307)(scope, receive, send)
        else:
            sentence = f"this station answers https alone: https://{secure.netloc}"
            await refuse(403, sentence, "NotAllowed")(scope, receive, send)


def _is_allowed(scope: Scope) -> bool:
    if scope["type"] == "websocket":
        return False
    path: str = scope["path"]
    if scope["method"] in SAFE_METHODS:
        return path.startswith(HTTP_PATHS)
    return is_stop(scope)
