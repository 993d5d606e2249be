"""The documents under /help: the site that `make docs` builds, each page with a policy for its own scripts alone."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path
from typing import Final

from fastapi import APIRouter, Request, Response
from fastapi.responses import PlainTextResponse, RedirectResponse

from teachpath.api.access import NO_CAPABILITY
from teachpath.api.page_files import PageFiles

HEADERS: Final = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}
MEDIA: Final = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webp": "image/webp",
    ".json": "application/json",
    ".txt": "text/plain; charset=utf-8",
}
_INLINE: Final = re.compile(rb"<script>(.*?)</script>", re.DOTALL)
_POLICY: Final = (
    "default-src 'none'",
    "style-src 'self' 'unsafe-inline'",
    "img-src 'self' data:",
    "connect-src 'self'",
    "worker-src 'self' blob:",  # the search
    "base-uri 'none'",
    "form-action 'none'",
    "frame-ancestors 'none'",
)


def help_router(folder: Path) -> APIRouter:
    """Return the routes of the documents; `folder` holds the site, or does not exist where it was not built."""
    router = APIRouter(include_in_schema=False)
    files, root = PageFiles(HEADERS), folder.resolve()

    @router.get("/help", dependencies=NO_CAPABILITY)
    def begin(request: Request) -> Response:
        """Send the reader to the first page."""
        return RedirectResponse(f"{request.scope.get('root_path', '')}/help/index.html")

    @router.get("/help/{name:path}", dependencies=NO_CAPABILITY)
    def document(request: Request, name: str) -> Response:
        """Answer with a file of the site; 404 where it has none of that name, or was not built."""
        if not root.is_dir():
            return _missing("the documents were not built here; build them with: make docs")
        if (path := _file(root, name or "index.html")) is None:
            return _missing(f"there is no document {name!r}; they begin at /help")
        scripts = _scripts(path) if path.suffix == ".html" else "'self'"
        policy = "; ".join((*_POLICY, f"script-src {scripts}"))
        return files.answer(request, path, MEDIA[path.suffix], headers={"Content-Security-Policy": policy})

    return router


def _file(root: Path, name: str) -> Path | None:
    """Return the file of a name below a folder; None: there is none, or none can be of that name."""
    try:
        path = (root / name).resolve()
        is_there = path.suffix in MEDIA and path.is_relative_to(root) and path.is_file()
    except (OSError, ValueError):  # too long a name, or one with a zero in it
        return None
    return path if is_there else None


def _scripts(page: Path) -> str:
    """Return the sources of scripts that a page may run: files of the site, and those that stand in the page."""
    digests = {base64.b64encode(hashlib.sha256(text).digest()).decode() for text in _INLINE.findall(page.read_bytes())}
    return " ".join(("'self'", *sorted(f"'sha256-{digest}'" for digest in digests)))


def _missing(sentence: str) -> Response:
    return PlainTextResponse(f"{sentence}\n", status_code=404, headers=HEADERS)
