"""What Python computes and the page computes again, as files for the page's unit tests.

python -m tests.page.fixtures    writes them anew
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.documents import to_document
from teachpath.learning.adaptation.adapted_course import CourseModel
from teachpath.learning.adaptation.kriged_shapes import KrigedShapes
from teachpath.motion.arm.description import describe_arm
from teachpath.motion.arm.kinematics import link_frames, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import VARIANTS
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import ToolPose
from teachpath_proto.display_names import id_of
from teachpath_proto.keys import is_name, name_refusal
from teachpath_proto.tracker_pb2 import HandSample, Quaternion, Vector3

FOLDER = Path(__file__).parent / "fixtures"
TILTED = (math.cos(0.3), 0.6 * math.sin(0.3), 0.8 * math.sin(0.3), 0.0)
GRASP, CLUTCH = 1, 4  # bits of HandSample.buttons

NAMES = ["demo", "a", "A9", "first-task", "x.y_z-0", "a" * 64]
DISPLAY_NAMES = [
    "Küche räumen", " Straße, Halle 3 (Süd)!", "naïve  café", "高台", "Ёлка 2", "Ångström", "Ku\u0308che", "İzmir Ω²",
    "x" * 63 + " y", "--", "a . . b", "ﬁne œuvre", "एक दो",
]  # fmt: skip
NO_NAMES = ["", " ", "-a", ".a", "_a", "a..b", "a/b", "a b", "a\u00e9", "\u4f60", "a" * 65, "a\n", "a\\b"]


def curves() -> list[dict[str, Any]]:
    """Curves of every degree, with their points, and the Greville abscissae of their control points."""
    chance = np.random.default_rng(1)
    return [_curve(chance, degree, inner) for degree in range(1, 8) for inner in ((), (0.5,), (0.2, 0.2, 0.7))]


def _curve(chance: np.random.Generator, degree: int, inner: tuple[float, ...]) -> dict[str, Any]:
    inner = tuple(u for i, u in enumerate(inner) if inner[:i].count(u) < degree)
    knots = [0.0] * (degree + 1) + list(inner) + [1.0] * (degree + 1)
    count = len(knots) - degree - 1
    curve = Curve(degree, np.array(knots), chance.uniform(-1, 1, (count, 3)), chance.uniform(0.2, 5, count))
    parameters = [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 0.999, 1.0]
    return {
        "degree": degree,
        "knots": knots,
        "control_points": curve.control_points.tolist(),
        "weights": curve.weights.tolist(),
        "parameters": parameters,
        "points": curve(np.array(parameters)).tolist(),
        "greville": [float(np.mean(knots[i + 1 : i + degree + 1])) for i in range(count)],
    }


def link_poses() -> list[dict[str, Any]]:
    """Poses of all links of published arms and of a model; column by column, as three.js has them."""
    chance = np.random.default_rng(2)
    model = read_arm("six-axis", base=((0.1, 0.2, 0.5), TILTED), gripper_length=0.13)
    return [_link_poses(Arm.of_model(model, MotionSettings()), chance.uniform(-math.pi, math.pi, 6))] + [
        _link_poses(replace(Arm.of_variant(name), tool=tool), chance.uniform(-math.pi, math.pi, 6))
        for name in VARIANTS
        for tool in (None, ToolPose((0.05, -0.02, 0.18), (0.5, 0.5, -0.5, 0.5)), ToolPose((0.0, 0.1, -0.05), TILTED))
    ]


def _link_poses(arm: Arm, q: np.ndarray) -> dict[str, Any]:
    return {
        "arm": to_document(describe_arm(arm, name="puma560", home=(0.0,) * 6)),
        "q": q.tolist(),
        "frames": [frame.T.ravel().tolist() for frame in link_frames(q, arm)],
        "tool": tool_pose(q, arm).T.ravel().tolist(),
    }


def hand_samples() -> list[dict[str, Any]]:
    """Samples of a hand as the page has them, with their message in hexadecimal digits."""
    turned = [0.5, -0.5, 0.5, -0.5]
    return [
        _hand_sample(1, 1_764_374_400_000.0, [0.58, -0.28, 0.52], None),
        _hand_sample(127, 1_764_374_400_000.25, [-1.5, 2.25, 1e-9], turned, grasp=True),
        _hand_sample(128, 1_764_374_400_016.667, [0.1, 0.2, 0.3], turned, clutch=True),
        _hand_sample(2**40, 1_764_374_400_033.333, [0.1, 0.2, 0.3], turned, tracked=False, grasp=True, clutch=True),
    ]


def _hand_sample(
    sequence: int, ms: float, position: list[float], orientation: list[float] | None, **held: bool
) -> dict[str, Any]:
    held = {"tracked": True, "grasp": False, "clutch": False} | held
    message = HandSample(
        sequence=sequence,
        device_ns=round(ms * 1000) * 1000,
        position=Vector3(**dict(zip("xyz", position, strict=True))),
        orientation=orientation and Quaternion(**dict(zip("wxyz", orientation, strict=True))),
        tracked=held["tracked"],
        buttons=GRASP * held["grasp"] + CLUTCH * held["clutch"],
    )
    sample = {"sequence": sequence, "ms": ms, "position": position, "orientation": orientation, **held}
    return {"sample": sample, "message": message.SerializeToString().hex()}


def motions() -> list[dict[str, Any]]:
    """A motion over time, and where it is between its samples."""
    chance = np.random.default_rng(3)
    times = 2.0 + np.cumsum(chance.uniform(0.01, 0.5, 12))
    joints, places = chance.uniform(-3, 3, (12, 6)), chance.uniform(-1, 1, (12, 3))
    turns = chance.normal(size=(12, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    closed = [3 <= i < 8 for i in range(12)]
    motion = {
        "times": times.tolist(),
        "joints": joints.tolist(),
        "gripper_closed": closed,
        "object_position": places.tolist(),
        "object_orientation": turns.tolist(),
    }
    duration = float(times[-1] - times[0])
    instants = [-1.0, 0.0, *(duration * np.array([0.1, 0.33, 0.5, 0.77, 0.99])).tolist(), duration, duration + 1]
    return [{"motion": motion, "samples": [_sample(times, joints, places, turns, closed, s) for s in instants]}]


def _sample(
    times: np.ndarray, joints: np.ndarray, places: np.ndarray, turns: np.ndarray, closed: list[bool], seconds: float
) -> dict[str, Any]:
    time = float(np.clip(times[0] + seconds, times[0], times[-1]))

    def at(rows: np.ndarray) -> np.ndarray:
        return np.array([np.interp(time, times, column) for column in rows.T])

    turn = at(turns)
    # from the last sample on, the page shows what the one before it holds
    row = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
    return {
        "seconds": seconds,
        "q": at(joints).tolist(),
        "position": at(places).tolist(),
        "orientation": (turn / np.linalg.norm(turn)).tolist(),
        "closed": closed[row],
    }


def names() -> list[dict[str, Any]]:
    """Texts, and whether each may name a task; the sentence that refuses it as one."""
    return [
        {"text": text, "is_name": is_name(text), "refusal": name_refusal("task", text)}
        for text in NAMES + [text for text in NO_NAMES if repr(text) == f"'{text}'"]
    ]


def display_names() -> list[dict[str, str]]:
    """What people call things, and the name that is made of each."""
    return [{"text": text, "id": id_of(text)} for text in NAMES + NO_NAMES + DISPLAY_NAMES]


def adaptations() -> list[dict[str, Any]]:
    """Models of paths of one demonstration, of several, and of a closed way, with paths that they predict."""
    chance = np.random.default_rng(3)
    return [_adaptation(chance, count, closed) for count, closed in ((1, False), (4, False), (3, True))]


def _adaptation(chance: np.random.Generator, count: int, closed: bool) -> dict[str, Any]:
    share = np.linspace(0.0, 1.0, 12)[:, None]
    shown = []
    for _ in range(count):
        start = np.array([0.4, -0.3, 0.5]) + chance.normal(0, 0.05, 3)
        goal = start if closed else np.array([0.5, 0.3, 0.55]) + chance.normal(0, 0.05, 3)
        bow = np.sin(np.pi * share) * chance.normal([0.1, 0.0, 0.2], 0.02)
        shown.append(start + share * (goal - start) + bow + np.sin(2 * np.pi * share) * chance.normal(0, 0.05, 3))
    edited = shown[0] + 0.05 * np.sin(np.pi * share) ** 2 * chance.normal(0, 1, 3)
    model = CourseModel(KrigedShapes(np.array(shown)), shown[0], edited)
    predictions = []
    ends = [tuple(shown[0][end] + chance.normal(0, 1, 3) * spread for end in (0, -1)) for spread in (0.0, 0.005, 0.15)]
    first, last = shown[0][[0, -1]]
    beyond = ([0.7, 0.7, 0.0], [0.0, 0.0, 0.6], [0.5, -0.65, 0.0])  # farther, higher, and in another direction
    ends += [(first, last + np.array(shift)) for shift in beyond]
    for start, goal in ends:
        found = model.predict(start, goal)
        named = {"start": start, "goal": goal, "path": found.path, "deviation": found.deviation}
        numbers = {name: values.tolist() for name, values in named.items()}
        predictions.append({**numbers, "extrapolates": found.extrapolates})
    return {"model": to_document(model.export(min(count, 2))), "predictions": predictions}


FIXTURES: dict[str, Callable[[], list[dict[str, Any]]]] = {
    "curves": curves,
    "link_poses": link_poses,
    "hand_samples": hand_samples,
    "motions": motions,
    "adaptations": adaptations,
    "names": names,
    "display_names": display_names,
}


def write() -> None:
    """Write all fixtures."""
    FOLDER.mkdir(exist_ok=True)
    for name, compute in FIXTURES.items():
        (FOLDER / f"{name}.json").write_text(json.dumps(compute(), indent=1) + "\n")


if __name__ == "__main__":
    write()
