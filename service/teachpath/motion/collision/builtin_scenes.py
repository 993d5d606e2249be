"""The built-in scenes, in the world frame: the table's top lies at z = 0.50 m."""

from __future__ import annotations

from typing import Final

from teachpath.records import Scene, Shape

TABLE_HEIGHT: Final = 0.50  # m
_TABLE: Final = Shape("table", "box", (0.9, 1.2, 0.04), (0.60, 0.0, TABLE_HEIGHT - 0.02), 0xC9BBA4)


def paper_scene() -> Scene:
    """Return the scene of the first experiment of Aleotti & Caselli 2005: a box and a cylinder to go around.

    There are three ways from the start to the goal at the other side: near the robot, between the obstacles, far.
    """
    return Scene(
        name="paper",
        obstacles=(
            _TABLE,
            Shape("box", "box", (0.07, 0.09, 0.16), (0.48, 0.0, TABLE_HEIGHT + 0.08), 0x7C8896),
            Shape("cylinder", "cylinder", (0.035, 0.20), (0.68, 0.0, TABLE_HEIGHT + 0.10), 0x7C8896),
        ),
        carried=Shape("block", "box", (0.04, 0.04, 0.04), (0.58, -0.28, TABLE_HEIGHT + 0.02), 0xE8C547),
    )


def empty_scene() -> Scene:
    """Return a scene with a table and nothing on it."""
    return Scene(name="empty", obstacles=(_TABLE,))


def builtin_scenes() -> dict[str, Scene]:
    """Return the built-in scenes by name."""
    return {scene.name: scene for scene in (paper_scene(), empty_scene())}
