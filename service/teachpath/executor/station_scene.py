"""Asks the station what stands around an arm that follows a live hand: no order can bring a scene of its own."""

from __future__ import annotations

from typing import Final

from teachpath.errors import PathRefused, Unreachable
from teachpath.io import documents
from teachpath.io.bus import Bus
from teachpath.records import Scene, SceneQuery
from teachpath_proto.keys import Keys

ANSWER_TIMEOUT: Final = 5.0  # [s] that the service may take to answer; without an answer nothing moves


def ask_scene(bus: Bus, keys: Keys, name: str) -> Scene:
    """Return a scene as the station has it now, its object where it was told to lie.

    Raises:
        NotFound: the station has no scene of this name.
        PathRefused: the service does not answer.
    """
    query = documents.encode(SceneQuery(name))
    try:
        return documents.decode(Scene, bus.ask(keys.station_scene, query, timeout=ANSWER_TIMEOUT))
    except Unreachable:
        raise PathRefused(
            f"the service did not answer what stands in scene {name}, and the arm follows no hand without that; start "
            "the service (teachpath serve), then begin again"
        ) from None
