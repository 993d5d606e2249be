"""Send demonstrations to a teachpath station, and let it learn, plan and move: trackers, replay, and a typed client.

What is listed here is loaded when it is first used, so that a program which only asks does not wait for the bus.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teachpath_client.errors import ClientError
    from teachpath_client.link import Link
    from teachpath_client.reading import HandReading
    from teachpath_client.station import Station
    from teachpath_client.tracker import Routine, Tracker

__version__ = "1.0.0"

__all__ = ["ClientError", "HandReading", "Link", "Routine", "Station", "Tracker"]

_MODULES = {
    "ClientError": "errors",
    "HandReading": "reading",
    "Link": "link",
    "Routine": "tracker",
    "Station": "station",
    "Tracker": "tracker",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module 'teachpath_client' has no attribute {name!r}")
    return getattr(import_module(f"teachpath_client.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
