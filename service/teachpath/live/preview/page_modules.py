"""The page's modules as a browser imports them from within one file: an import map of `data:` addresses.

A page that was opened from a file may not import other files, and a module under a `data:` address has no place that a
relative specifier could start from. So every specifier becomes a bare name, which the import map knows.
"""

from __future__ import annotations

import base64
import posixpath
import re
from collections.abc import Callable, Mapping

_SPECIFIER = re.compile(
    r"""(?<=\bfrom )["'](\.{1,2}/[^"']+)["']|(?<=^import )["'](\.{1,2}/[^"']+)["'];""", re.MULTILINE
)
_DYNAMIC_IMPORT = re.compile(r"""(?<=\bawait import\()["'](\.{1,2}/[^"']+)["'](?=\))""")


def import_map(entry: str, read: Callable[[str], str], *, instead: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """Return the import map of a module and all that it imports; their names are `page/` and the path.

    Args:
        entry: path of the module, relative to the page's folder.
        read: gives the text of a module by its path.
        instead: paths of modules, with the path of another one that takes their place.
    """
    texts: dict[str, str] = {}
    waiting = [entry]
    while waiting:
        path = waiting.pop()
        if path in texts:
            continue
        text = read(instead.get(path, path))
        folder = posixpath.dirname(instead.get(path, path))
        text, imported = _with_bare_names(text, folder, _SPECIFIER)
        texts[path], late = _with_bare_names(text, folder, _DYNAMIC_IMPORT)
        waiting += imported + late
    return {"imports": {f"page/{path}": data_address(text, "text/javascript") for path, text in sorted(texts.items())}}


def imported_modules(entry: str, read: Callable[[str], str]) -> list[str]:
    """Return the paths of a module and of all that it imports when it is loaded, directly or not."""
    found: dict[str, None] = {}
    waiting = [entry]
    while waiting:
        path = waiting.pop(0)
        if path not in found:
            found[path] = None
            waiting += _with_bare_names(read(path), posixpath.dirname(path), _SPECIFIER)[1]
    return list(found)


def data_address(text: str, kind: str) -> str:
    """Return the `data:` address of a text of a media type."""
    return f"data:{kind};charset=utf-8;base64,{base64.b64encode(text.encode()).decode()}"


def _with_bare_names(text: str, folder: str, specifier: re.Pattern[str]) -> tuple[str, list[str]]:
    imported = []

    def bare(found: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(folder, next(group for group in found.groups() if group)))
        imported.append(path)
        return f'"page/{path}"' + (";" if found[0].endswith(";") else "")

    return specifier.sub(bare, text), imported
