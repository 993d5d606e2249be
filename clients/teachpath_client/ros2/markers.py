"""Demonstrations and learned paths as markers of ROS 2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from teachpath_client.curve_points import curve_points
from teachpath_client.models import Demonstration
from teachpath_client.ros2.messages import MARKERS, header, make
from teachpath_client.ros2.node import Node
from teachpath_client.station import Station

Points = Sequence[Sequence[float]]
Color = tuple[float, float, float, float]

LINE_STRIP, ADD, DELETE_ALL = 4, 0, 3  # of visualization_msgs/Marker
PATH_POINTS, DEMONSTRATION_POINTS = 200, 200  # at most, of a line
PATH_WIDTH, DEMONSTRATION_WIDTH = 0.006, 0.002  # [m]
PATH_COLOR: Final[Color] = (0.0, 0.45, 0.7, 1.0)  # after Okabe and Ito: told apart without seeing red or green
USED_COLOR: Final[Color] = (0.34, 0.71, 0.91, 0.8)
LEFT_OUT_COLOR: Final[Color] = (0.6, 0.6, 0.6, 0.5)


@dataclass(frozen=True)
class Polyline:
    """A line in the world.

    Attributes:
        group: namespace of its marker; with `name` unique.
        name: of what it is.
        points: (n, 3) [m, world].
        color: red, green, blue, opacity.
        width: [m].
    """

    group: str
    name: str
    points: Points
    color: Color
    width: float


class TaskMarkers:
    """Publishes the lines of tasks.

    Args:
        node: that publishes.
        station: that has the tasks.
        tasks: their names.
        topic: its name.
        world: frame of the station's world.
        bridged: the router is zenoh-bridge-ros2dds.
    """

    def __init__(
        self, node: Node, station: Station, tasks: Sequence[str], topic: str, world: str, *, bridged: bool = False
    ) -> None:
        self._node, self._station, self._tasks, self._world = node, station, tasks, world
        self._publisher = node.publisher(topic, MARKERS, bridged=bridged)
        self._read: dict[str, tuple[Demonstration, Points]] = {}  # trajectories by id, with the row they are of

    def step(self) -> int:
        """Publish all lines as they are now, if somebody subscribes, and return how many; raises ClientError."""
        if not self._node.is_subscribed(self._publisher.topic):
            return 0
        lines = [line for task in self._tasks for line in self._lines(task)]
        self._publisher.put(markers=markers(lines, self._world))
        return len(lines)

    def _lines(self, task: str) -> list[Polyline]:
        run = self._station.newest_run(task)
        used = {member for each in run.learned.clusters for member in each.members} if run else set()
        lines = [
            Polyline(
                f"{task}/demonstrations",
                f"{each.number}",
                self._points(each),
                USED_COLOR if each.id in used else LEFT_OUT_COLOR,
                DEMONSTRATION_WIDTH,
            )
            for each in self._station.demonstrations(task)
            if each.verdict != "reject" and not each.discarded_ns
        ]
        for path in run.learned.paths if run else ():
            newest = self._station.get_path(path.id)
            points = curve_points(newest.curve, PATH_POINTS).tolist()
            lines.append(Polyline(f"{task}/paths", f"{path.cluster}", points, PATH_COLOR, PATH_WIDTH))
        return lines

    def _points(self, demonstration: Demonstration) -> Points:
        """Return a demonstration's line; it is read anew only when the demonstration was amended."""
        known = self._read.get(demonstration.id)
        if known is None or known[0] != demonstration:
            trajectory = self._station.trajectory(demonstration.id, most=DEMONSTRATION_POINTS)
            known = self._read[demonstration.id] = (demonstration, trajectory.positions)
        return known[1]


def markers(lines: Sequence[Polyline], world: str) -> list[Any]:
    """Return the markers of lines; the first one deletes what was shown before."""
    return [_marker(world, "", 0, DELETE_ALL, None)] + [
        _marker(world, line.group, number, ADD, line) for number, line in enumerate(lines)
    ]


def _marker(world: str, group: str, number: int, action: int, line: Polyline | None) -> Any:
    color = line.color if line else (0.0, 0.0, 0.0, 0.0)
    return make(
        "visualization_msgs/msg/Marker",
        header=header(0, world),  # a stamp of 0: as the frame is now
        ns=group,
        id=number,
        type=LINE_STRIP,
        action=action,
        pose=make(
            "geometry_msgs/msg/Pose",
            position=_vector("Point"),
            orientation=make("geometry_msgs/msg/Quaternion", **_IDENTITY_ORIENTATION),
        ),
        scale=_vector("Vector3", (line.width if line else 0.0, 0.0, 0.0)),
        color=make("std_msgs/msg/ColorRGBA", **dict(zip("rgba", color, strict=True))),
        lifetime=make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        frame_locked=False,
        points=[_vector("Point", point) for point in (line.points if line else ())],
        colors=[],
        texture_resource="",
        texture=make("sensor_msgs/msg/CompressedImage", header=header(0, ""), format="", data=np.empty(0, np.uint8)),
        uv_coordinates=[],
        text=line.name if line else "",
        mesh_resource="",
        mesh_file=make("visualization_msgs/msg/MeshFile", filename="", data=np.empty(0, np.uint8)),
        mesh_use_embedded_materials=False,
    )


_IDENTITY_ORIENTATION: Final = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}


def _vector(kind: str, values: Sequence[float] = (0.0, 0.0, 0.0)) -> Any:
    return make(f"geometry_msgs/msg/{kind}", **dict(zip("xyz", values, strict=True)))
