"""Where the object of a recording lies: where the scene has it, where it was told to lie, or where the hand grasps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from teachpath.records import ObjectPose, Shape, Vector


class ObjectPlace:
    """Follows where the object lies from take to take, and keeps where it lay when the hand grasped it.

    Args:
        shape: the object where the scene has it; None: the scene has none.
        reported: returns where it was told to lie; None: nowhere else.
        at_grasp: it lies where the hand grasps.
    """

    def __init__(self, shape: Shape | None, reported: Callable[[], ObjectPose | None], *, at_grasp: bool) -> None:
        self._shape = shape
        self._reported = reported
        self._at_grasp = at_grasp and shape is not None
        self._present = self._read()
        self._grasped = self._present

    @property
    def expected(self) -> Vector | None:
        """Where the hand has to grasp [m, world]; None: anywhere."""
        if self._shape is None or self._at_grasp:
            return None
        return self._present.position if self._present else self._shape.position

    @property
    def scene_position(self) -> Vector | None:
        """Its centre [m, world] where the scene has it; None without an object."""
        return self._shape.position if self._shape else None

    @property
    def reported(self) -> ObjectPose | None:
        """Where it was told to lie; None = where the scene has it."""
        return self._present

    def shape(self, *, grasped: bool) -> Shape | None:
        """Return the object where it was grasped last, or else where it lies."""
        pose = self._grasped if grasped else self._present
        if self._shape is None or pose is None:
            return self._shape
        return replace(self._shape, position=pose.position, orientation=pose.orientation)

    @property
    def start(self) -> Vector | None:
        """Its centre [m, world] when it was grasped last; None without an object."""
        shape = self.shape(grasped=True)
        return shape.position if shape else None

    @property
    def pose(self) -> ObjectPose | None:
        """Its pose when it was grasped last; None = where the scene has it."""
        return self._grasped

    def has_moved(self) -> bool:
        """Look where it was told to lie; return whether that has changed."""
        before, self._present = self._present, self._read()
        return self._present != before

    def on_grasp(self, hand: Vector) -> None:
        """Keep where the object lies, because the hand grasps it at this position [m, world]."""
        if self._at_grasp:
            assert self._shape is not None
            self._grasped = ObjectPose(hand, self._shape.orientation)
        else:
            self._grasped = self._present

    def _read(self) -> ObjectPose | None:
        return None if self._shape is None or self._at_grasp else self._reported()
