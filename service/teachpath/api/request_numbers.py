"""A number for every request: in the header of its answer, and in every line of the log that it causes."""

from __future__ import annotations

import logging
import time
from typing import Final

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.api.middleware import SAFE_METHODS
from teachpath.logs import begin_request

HEADER: Final = "Teachpath-Request"
API: Final = "/api/"
# Of its answers, unless they say otherwise: no browser guesses what they are, keeps them, or gives them to other sites.
OF_API: Final = {
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
}
ROUTINE: Final = ("/lease/beat",)  # ends of the paths of what programs send all the time

log: logging.Logger = logging.getLogger(__name__)


class RequestNumbers:
    """Numbers every request; what changes something is logged with its status and time. A middleware."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        number, begin = begin_request(), time.monotonic()

        async def numbered(message: Message) -> None:
            """Send a message; the first one of an answer gets the number, and is logged where it changed something."""
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers[HEADER] = number
                if scope["path"].startswith(API):
                    for name, value in OF_API.items():
                        headers.setdefault(name, value)
                if scope["method"] not in SAFE_METHODS and not scope["path"].endswith(ROUTINE):
                    took = 1e3 * (time.monotonic() - begin)
                    log.info("%s %s: %d, %.0f ms", scope["method"], scope["path"], message["status"], took)
            await send(message)

        await self._app(scope, receive, numbered)
