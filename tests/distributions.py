"""What an install of this project brings, by what the installed distributions say that they need."""

from functools import cache
from importlib.metadata import PackageNotFoundError, requires

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


@cache
def required(*extras: str) -> frozenset[str]:
    """Return the names of all distributions that `teachpath[EXTRAS]` brings, itself not among them."""
    found: set[tuple[str, frozenset[str]]] = set()
    waiting = [Requirement(f"teachpath[{','.join(extras)}]")]
    while waiting:
        needed = waiting.pop()
        key = (canonicalize_name(needed.name), frozenset(needed.extras))
        if key in found:
            continue
        try:
            lines = requires(needed.name) or []
        except PackageNotFoundError:  # left out here: see tool.uv.dependency-metadata
            continue
        found.add(key)
        waiting += [further for further in map(Requirement, lines) if _is_meant(further, key[1])]
    return frozenset(name for name, _ in found if name != "teachpath")


def _is_meant(requirement: Requirement, extras: frozenset[str]) -> bool:
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": extra}) for extra in ("", *extras))
