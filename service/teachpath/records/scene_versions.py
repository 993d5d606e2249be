"""Versions of a scene that is changed at a station."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records.motion import Scene


@dataclass(frozen=True, slots=True)
class SceneVersion:
    """Who changed a scene, and when.

    Attributes:
        scene: its name.
        number: from 1, in the order of saving; a scene of the settings is the first one.
        created_ns: when it was saved [ns since the Unix epoch]; 0: it stands in the settings, and was never changed.
        author: who changed it; empty: not said.
        note: why; empty: not said.
        removed: the scene was removed with this version, which holds it as it was last.
    """

    scene: str
    number: int
    created_ns: int
    author: str = ""
    note: str = ""
    removed: bool = False


@dataclass(frozen=True, slots=True)
class SavedScene:
    """A version of a scene, and the scene itself.

    Attributes:
        version: who saved it, and when.
        scene: as it is in this version.
    """

    version: SceneVersion
    scene: Scene
