"""How kernels are compiled, by numba: kept on disk, never staler than their sources, and with nothing that lets two
runs round differently.
"""

from __future__ import annotations

import hashlib
import inspect
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])

_settings: Any = numba.config  # whose names numba makes when it is imported


def compiled(**options: Any) -> Callable[[F], F]:
    """Compile a function at its first call, and keep the result on disk where a place for it can be written.

    numba keeps a kernel until the kernel's own file changes, though it holds the code of all that it calls. So each
    version of the folder has a place of its own, and a kernel may use nothing of another folder.

    No kernel allows the compiler to reorder sums or to fuse products with sums (fastmath), because the compiler then
    chooses differently in different runs: a kernel from the cache is optimised once more than one that was compiled in
    the same process.

    Args:
        options: of `numba.njit`.
    """

    def compile_later(function: F) -> F:
        """Return `function` compiled at its first call; kept in memory alone where no folder can be written."""
        before = _settings.CACHE_DIR
        _settings.CACHE_DIR = str(_place(Path(inspect.getfile(function)).parent, before))
        try:
            return cast(F, numba.njit(cache=True, **options)(function))
        except RuntimeError:  # no directory that numba could write to
            return cast(F, numba.njit(**options)(function))
        finally:
            _settings.CACHE_DIR = before

    return compile_later


@cache
def _place(folder: Path, chosen: str) -> Path:
    """Return where the kernels of a folder are kept; `chosen` is the directory that NUMBA_CACHE_DIR names, or empty."""
    if chosen:
        base = Path(chosen)
    elif os.access(folder, os.W_OK):
        base = folder / "__pycache__"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "teachpath"
    return base / f"kernels-{source_digest(folder)}"


def source_digest(folder: Path) -> str:
    """Return a digest of all Python sources of a folder."""
    digest = hashlib.sha256()
    for file in sorted(folder.glob("*.py")):
        digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
