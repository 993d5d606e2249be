"""Import the modules of a package without running the package's own `__init__`."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_init(name: str) -> Iterator[None]:
    """Let modules of the package `name` be imported in this context without what its `__init__` imports.

    Afterwards `import name` runs the `__init__` as always. A package that is not installed, or that was imported
    before, is left as it is.
    """
    spec = None if name in sys.modules else importlib.util.find_spec(name)
    if spec is None:
        yield
        return
    sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        yield
    finally:
        del sys.modules[name]
