"""The page's files as they are sent: compressed, without comments, 304 while a browser has them, modules announced."""

from __future__ import annotations

import gzip
import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fastapi import Request, Response

from teachpath.live.preview.page_modules import imported_modules

LEAST_COMPRESSED: Final = 1000  # bytes; a shorter file gains nothing
NO_SOURCES: Final[Mapping[str, str]] = {}
# Comments that have their lines to themselves; line numbers stay.
COMMENTS: Final = re.compile(rb"^[ \t]*(?:/\*\*(?:(?!\*/).)*\*/|//[^\n]*)$", re.MULTILINE | re.DOTALL)
PRELOAD: Final = "<!-- preload -->"  # where the page announces its modules


@dataclass(frozen=True)
class _Content:
    """A file as it is sent; `packed` is empty where it is not compressed."""

    plain: bytes
    packed: bytes
    tag: str


class PageFiles:
    """Files in memory, read anew when they have changed.

    Args:
        headers: of every answer.
    """

    def __init__(self, headers: Mapping[str, str]) -> None:
        self._headers = dict(headers)
        self._contents: dict[Path, tuple[tuple[int, int], _Content]] = {}

    def answer(
        self,
        request: Request,
        file: Path,
        media_type: str,
        *,
        entry: str = "",
        headers: Mapping[str, str] = NO_SOURCES,
        bare: bool = False,
    ) -> Response:
        """Return a file as an answer, or 304 where the browser has it; raises FileNotFoundError.

        Args:
            request: says what the browser has, and whether it takes a compressed answer.
            file: to send.
            media_type: of the file.
            entry: name of the page's first module beside the file; all that it imports is announced in the file.
            headers: of this answer, beside those of all.
            bare: it is a module of ours, which is sent without its comments.
        """
        content = self._read(file, entry, bare)
        sent = self._headers | {"ETag": content.tag, "Vary": "Accept-Encoding"} | dict(headers)
        if content.tag in request.headers.get("if-none-match", ""):
            return Response(status_code=304, headers=sent)
        body = content.plain
        if content.packed and "gzip" in request.headers.get("accept-encoding", ""):
            body, sent["Content-Encoding"] = content.packed, "gzip"
        return Response(body, headers=sent, media_type=media_type)

    def _read(self, file: Path, entry: str, bare: bool) -> _Content:
        state = file.stat()
        version = state.st_mtime_ns, state.st_size
        known, content = self._contents.get(file, (None, None))
        if known == version and content is not None and not entry:
            return content
        plain = file.read_bytes()
        if bare:
            plain = without_comments(plain)
        if entry:
            plain = plain.replace(PRELOAD.encode(), _preload_links(file.parent, entry).encode())
        packed = gzip.compress(plain, mtime=0) if len(plain) > LEAST_COMPRESSED else b""
        content = _Content(plain, packed, f'"{hashlib.sha256(plain).hexdigest()[:32]}"')
        self._contents[file] = version, content
        return content


def without_comments(module: bytes) -> bytes:
    """Return the text of a module with empty lines where comments have lines to themselves."""
    return COMMENTS.sub(lambda comment: b"\n" * comment[0].count(b"\n"), module)


def _preload_links(folder: Path, entry: str) -> str:
    """Return elements that let a browser read all modules at once; else it finds them from import to import."""
    modules = imported_modules(entry, lambda path: (folder / path).read_text())
    return "\n  ".join(f'<link rel="modulepreload" href="web/{path}">' for path in modules)
