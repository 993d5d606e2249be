"""The source contract: whatever yields hand readings can be published, and third parties add their own.

A source is found by its name among the entry points of the group `teachpath.sources`. The entry point is a callable
that takes its options as keyword strings and returns a `Source`; the first line of its docstring is what
`teachpath-client sources` prints:

    [project.entry-points."teachpath.sources"]
    mydevice = "mypackage.mymodule:MySource"
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields
from importlib.metadata import EntryPoint, entry_points
from types import TracebackType
from typing import Any, Literal, Protocol, Self, TypeVar, cast, get_args, get_origin, get_type_hints

from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

GROUP = "teachpath.sources"

Settings = TypeVar("Settings")


@dataclass(frozen=True)
class Capabilities:
    """What a source measures."""

    # [Hz] readings it means to give; 0 = not known
    rate: float
    # flexions in a reading: 0, 18 or 22
    sensors: int
    # whether it measures the orientation of the hand
    orientation: bool
    # whether readings come when they are measured; False: they are all there and are paced when published
    live: bool
    # whether it can be felt, see `TouchSource`
    touch: bool = False


class Source(Protocol):
    """Readings of one hand, in the order of their time.

    Entering the context connects and raises ClientError when nothing answers; leaving it lets go of the device. No
    reading was measured before that; the time of the first is 0 and never runs back; what was not measured is missing,
    never repeated.
    """

    @property
    def capabilities(self) -> Capabilities:
        """What this source measures."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def __iter__(self) -> Iterator[HandReading]: ...

    def close(self) -> None:
        """End the iteration soon; may be called by a signal handler or another thread, and more than once."""


class TouchSource(Source, Protocol):
    """A source with a device that can vibrate."""

    def touch(self, holding: bool) -> None:
        """Start the vibration when the hand holds the object, or stop it."""


def open_source(name: str, options: Mapping[str, str]) -> Source:
    """Make the source `name` with its options; it connects when its context is entered.

    Raises:
        ClientError: there is no such source, its package is broken, or an option is not usable.
    """
    known = _known()
    if name not in known:
        raise ClientError(f"there is no source named {name}; there are {', '.join(sorted(known))}")
    make = _load(known[name])
    try:
        return make(**options)
    except TypeError as error:
        raise ClientError(f"source {name} does not take these options: {error}") from error


def describe_sources() -> dict[str, str]:
    """Return the names of all sources, each with one line that says what it is."""
    described = {}
    for name, entry in sorted(_known().items()):
        try:
            lines = (_load(entry).__doc__ or "").strip().splitlines()
            described[name] = lines[0] if lines else entry.value
        except ClientError as error:
            described[name] = f"({error})"
    return described


def configure(kind: type[Settings], options: Mapping[str, str], *, prefix: str = "") -> Settings:
    """Return the settings dataclass `kind` with its fields read from texts; messages show names with `prefix`.

    Fields may be str, int, float, tuple[int, ...] or tuple[float, ...] (separated by commas) or a Literal of texts.

    Raises:
        ClientError: an option is unknown, missing, or not of its kind.
    """
    hints = get_type_hints(kind)
    known = {field.name: field for field in fields(kind)}  # type: ignore[arg-type]
    for name in options:
        if name not in known:
            raise ClientError(f"there is no option {prefix}{name}; there are {', '.join(known)}")
    for name, field in known.items():
        if name not in options and field.default is MISSING:
            raise ClientError(f"the option {prefix}{name} is missing; say --option {prefix}{name}=...")
    return kind(**{name: _value(name, text, hints[name]) for name, text in options.items()})


def _value(name: str, text: str, hint: Any) -> Any:
    if get_origin(hint) is Literal:
        if text not in get_args(hint):
            raise ClientError(f"{name}={text} is not one of {', '.join(get_args(hint))}")
        return text
    try:
        return tuple(map(get_args(hint)[0], text.split(","))) if get_origin(hint) is tuple else hint(text)
    except ValueError as error:
        raise ClientError(f"{name}={text} is not usable: {error}") from error


def _known() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}


def _load(entry: EntryPoint) -> Callable[..., Source]:
    try:
        return cast("Callable[..., Source]", entry.load())
    except (ImportError, AttributeError) as error:
        raise ClientError(f"the source {entry.name} cannot be loaded from {entry.value}: {error}") from error
