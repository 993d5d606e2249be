"""The page and its 3-D view: static files under a strict content security policy, and the view's WebSocket."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from fastapi import APIRouter, Request, Response, WebSocket
from fastapi.responses import PlainTextResponse

from teachpath.api import sockets
from teachpath.api.access import NO_CAPABILITY, VIEW
from teachpath.api.help import help_router
from teachpath.api.page_files import PageFiles
from teachpath.live.preview.asset_paths import VIEWER_STYLES, help_files, viewer_files, web_files
from teachpath.live.preview.preview import Preview
from teachpath.live.preview.scene_tree import Viewer

HEADERS: Final = {
    "Content-Security-Policy": "; ".join(
        (
            "default-src 'none'",
            "script-src 'self'",
            "style-src 'self' " + " ".join(f"'{digest}'" for digest in VIEWER_STYLES),
            "connect-src 'self'",
            "img-src 'self' data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        )
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}
# What a page loads obeys the policy of the page; only documents, and threads of a page, have their own.
PART_HEADERS: Final = {name: HEADERS[name] for name in ("X-Content-Type-Options", "Cache-Control")}
THREADS: Final = ("hand/sample_worker.js",)  # scripts that the page runs as threads
HTML: Final = "text/html; charset=utf-8"
MEDIA: Final = {
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
_VENDOR_FILES: Final = {
    "meshcat.min.js": ("dist/main.min.js", ".js"),
    "meshcat.min.js.LICENSE.txt": ("dist/main.min.js.LICENSE.txt", ".txt"),
    "meshcat.LICENSE.txt": ("LICENSE", ".txt"),
}


def view_router(preview: Preview) -> APIRouter:
    """Return the routes of the pages, their files and the view.

    They are `/`, `/docs`, `/help/`, `/web/`, `/vendor/` and `/api/v1/view`.
    """
    router = APIRouter(include_in_schema=False)
    router.include_router(help_router(help_files()))
    root, viewer = web_files(), viewer_files()
    files, parts = PageFiles(HEADERS), PageFiles(PART_HEADERS)

    def answer(request: Request, path: Path, suffix: str, *, bare: bool = False) -> Response:
        is_thread = any(path == root / name for name in THREADS)
        sender = files if is_thread else parts
        return sender.answer(request, path, MEDIA[suffix], bare=bare) if path.is_file() else _missing(path.name)

    @router.get("/", dependencies=NO_CAPABILITY)
    def page(request: Request) -> Response:
        """Return the operator's page."""
        return files.answer(request, root / "index.html", HTML, entry="page.js")

    @router.get("/docs", dependencies=NO_CAPABILITY)
    def docs(request: Request) -> Response:
        """Return the page that shows the API."""
        return files.answer(request, root / "docs.html", HTML)

    @router.get("/favicon.ico", dependencies=NO_CAPABILITY)
    def icon(request: Request) -> Response:
        """Return the icon that browsers ask for."""
        return answer(request, root / "icon.svg", ".svg")

    @router.get("/web/{name:path}", dependencies=NO_CAPABILITY)
    def module(request: Request, name: str) -> Response:
        """Return a file of the page, and nothing from outside its folder."""
        try:
            path = (root / name).resolve(strict=True)
        except (OSError, ValueError):  # no name that a file can have
            return _missing(name)
        if path.suffix not in MEDIA or not path.is_relative_to(root.resolve()):
            return _missing(name)
        is_ours = path.suffix == ".js" and not path.is_relative_to(root.resolve() / "vendor")
        return answer(request, path, path.suffix, bare=is_ours)

    @router.get("/vendor/{name}", dependencies=NO_CAPABILITY)
    def vendored(request: Request, name: str) -> Response:
        """Return a library that the page loads."""
        place, suffix = _VENDOR_FILES.get(name, ("", ""))
        return answer(request, viewer / place, suffix) if place else _missing(name)

    @router.websocket("/api/v1/view", dependencies=VIEW)
    async def view(socket: WebSocket) -> None:
        """Send the 3-D view and its changes."""
        if await sockets.accept(socket):
            await sockets.serve(socket, preview.connect, preview.disconnect, socket.send_bytes, _acknowledge)

    return router


def _acknowledge(text: str, page: Viewer) -> str:
    """Take how many batches a page has drawn."""
    if not (text.isascii() and text.isdigit() and len(text) < 9):
        return "only counts of drawn batches are expected here"
    page.acknowledge(int(text))
    return ""


def _missing(name: str) -> Response:
    return PlainTextResponse(f"the page has no file {name!r}\n", status_code=404, headers=HEADERS)
