"""How the kernels of learning are compiled: by numba, with nothing that lets two runs round differently."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def compiled(**options: Any) -> Callable[[F], F]:
    """Compile a function at its first call, and keep the result on disk where a place for it can be written.

    No kernel allows the compiler to reorder sums or to fuse products with sums (fastmath), because the compiler then
    chooses differently in different runs: a kernel from numba's cache is optimised once more than one that was compiled
    in the same process.
    """

    def compile_later(function: F) -> F:
        try:
            return cast(F, numba.njit(cache=True, **options)(function))
        except RuntimeError:  # no directory that numba could write to
            return cast(F, numba.njit(**options)(function))

    return compile_later
