"""The 3-D scene of a review package: one batch of the viewer's commands, and the arm's poses against time."""

from __future__ import annotations

from typing import Any

import numpy as np

from teachpath.io.memory_bus import MemoryBus
from teachpath.live.preview import commands
from teachpath.live.preview.commands import CLUSTER_COLORS
from teachpath.live.preview.preview import Preview
from teachpath.live.preview.scene_tree import pack
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.offline.report.content import Review
from teachpath.records import Array, MotionPreview, Shape
from teachpath_proto.keys import Keys

POINTS = 160  # of a path and of a demonstration as drawn
RED = 0xD62718  # of deviations and keep-out zones
GREEN = 0x2A8F5A  # of keep-in zones
FRAMES = 240  # of a motion; the viewer goes evenly from one to the next


def way_color(cluster: int) -> int:
    """Return the colour of a way, 0xRRGGBB."""
    return CLUSTER_COLORS[(cluster - 1) % len(CLUSTER_COLORS)]


def scene_batch(review: Review, home: Array) -> bytes:
    """Return the commands that draw all that stands: arm, scene, demonstrations and paths."""
    preview = Preview(MemoryBus(), Keys(), visual_solids(), arm=review.arm, robot="", home=home, statuses=list)
    preview.show_object(review.scene.carried)
    arm = preview.connect(lambda: None).pop() or b""
    scene = review.scene
    drawn = [_drawn(f"/scene/{s.name}", s, s.color) for s in scene.obstacles]
    drawn += [_drawn(f"/zones/{s.name}", s, GREEN, opacity=0.05) for s in scene.keep_in]
    drawn += [_drawn(f"/zones/{s.name}", s, RED, opacity=0.18) for s in scene.keep_out]
    ways = {member: cluster.index for cluster in review.run.learned.clusters for member in cluster.members}
    for key, trajectory in review.trajectories.items():
        positions = trajectory.thinned(POINTS).positions
        if len(positions) > 1:
            color = way_color(ways[key]) if key in ways else 0x7A8694
            drawn.append(commands.line(f"/demonstrations/{key}", positions, color=color, opacity=0.7))
    u = np.linspace(0.0, 1.0, POINTS)
    for path in review.paths:
        color = way_color(path.cluster)
        drawn.append(commands.tube(f"/paths/{path.id}", path.curve(u), radius=0.005, color=color))
    return arm + pack(drawn + _deviations(review))


def _drawn(path: str, shape: Shape, color: int, *, opacity: float = 1.0) -> bytes:
    pose = commands.pose_of(shape.position, shape.orientation)
    return commands.solid(
        path, shape.kind, shape.size, pose=pose, color=color, opacity=opacity, vertices=shape.vertices
    )


def _deviations(review: Review) -> list[bytes]:
    """Draw where demonstrations depart from the others of their way."""
    drawn = []
    for score in (score for cluster in review.run.learned.clusters for score in cluster.scores):
        shown = review.trajectories.get(score.demonstration)
        if score.deviation is None or shown is None:
            continue
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(shown.positions, axis=0), axis=1))])
        begin, end = along[-1] * np.array(score.deviation.share)
        if end > begin:
            at = np.linspace(begin, end, POINTS // 2)
            points = np.column_stack([np.interp(at, along, column) for column in shown.positions.T])
            drawn.append(commands.tube(f"/departures/{score.demonstration}", points, radius=0.0032, color=RED))
    return drawn


def frames(motion: MotionPreview, arm: Arm) -> dict[str, Any]:
    """Return the poses of links and object: times [s] and, for each, 4 x 4 matrices column by column."""
    at = np.linspace(0, len(motion.times) - 1, min(FRAMES, len(motion.times))).round().astype(int)
    links = np.array([link_frames(q, arm) for q in motion.joints[at]])  # (n, 7, 4, 4)
    document = {
        "times": np.round(motion.times[at], 3).tolist(),
        "links": np.round(links.transpose(0, 1, 3, 2).reshape(len(at), -1, 16), 5).tolist(),
        "segments": [{"name": s.name, "begin": round(s.begin, 3), "end": round(s.end, 3)} for s in motion.segments],
    }
    if len(motion.object_position):
        poses = [
            commands.pose_of(tuple(position), tuple(turned))
            for position, turned in zip(motion.object_position[at], motion.object_orientation[at], strict=True)
        ]
        document["object"] = np.round(np.array(poses).transpose(0, 2, 1).reshape(-1, 16), 5).tolist()
    return document
