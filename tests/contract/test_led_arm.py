"""An arm that is led by hand shows a task: from a table of its joints to a plan that keeps to them, with an output."""

import json
from collections.abc import Iterator

import numpy as np
import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.motion.arm.model import Arm
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.planning.candidates import usable_candidates
from teachpath.motion.settings import MotionSettings
from teachpath.offline.recorded_arm import PUMA_JOINTS
from teachpath_client import Station
from teachpath_client.errors import ClientError
from tests.contract.desk import Desk, refused
from tests.unit.motion.ways import clamped

TASK = "led"
ARM, SETTINGS = Arm.of_variant(), MotionSettings()
RESTS = 15  # samples before and behind the path, in which the hand is open


def dear_posture() -> np.ndarray:
    """Joints (n, 6) along a straight way, the elbow up, as a plan would not choose them by itself."""
    path = sample_tool_path(clamped(np.linspace([0.5, -0.2, 0.65], [0.5, 0.2, 0.65], 8), degree=5), SETTINGS)
    first, *others = usable_candidates(enumerate_candidates(path, ARM, SETTINGS), SETTINGS)
    dear = next(c for c in others if np.abs(c.joints[0] - first.joints[0]).max() > 1.0 and c.joints[0, 1] > 1.0)
    return dear.joints[::2]


SHOWN_POSTURE = dear_posture()


def table(seed: int) -> bytes:
    """A table of joints that follow the posture, a little different each time."""
    wobble = 0.002 * np.sin(np.linspace(0.0, 6.0, len(SHOWN_POSTURE)) + seed)
    joints = np.pad(SHOWN_POSTURE + wobble[:, None], ((RESTS, RESTS), (0, 0)), mode="edge")
    joints[:RESTS, 0] -= 0.01 * np.arange(RESTS, 0, -1)  # it comes from beside, and leaves
    joints[-RESTS:, 0] += 0.01 * np.arange(1, RESTS + 1)
    grasp = np.pad(np.ones(len(SHOWN_POSTURE)), RESTS)
    columns = np.column_stack([0.02 * np.arange(len(joints)), joints, grasp])
    rows = [",".join(map(repr, row)) for row in columns.tolist()]
    return "\n".join([",".join(["t", *PUMA_JOINTS, "grasp"]), *rows, ""]).encode()


@pytest.fixture(scope="module")
def path(desk: Desk, port: int) -> Iterator[tuple[Station, str]]:
    with Station(f"http://127.0.0.1:{port}") as station:
        for seed in range(3):
            (made,) = desk.import_(TASK, table(seed), scene="empty", time="s")
            assert made["statistics"]["joints"] == 6
        yield station, station.learn(TASK).learned.paths[0].id


def test_a_plan_keeps_to_the_joints_that_were_shown_and_says_how_far_it_is(
    path: tuple[Station, str], port: int
) -> None:
    words = [
        "plan",
        f"{TASK}/1",
        "--output",
        "glue",
        "--output-start",
        "0.3",
        "--json",
        "--url",
        f"http://127.0.0.1:{port}",
    ]
    made = json.loads(CliRunner().invoke(app, words, catch_exceptions=False).stdout)
    assert made["output"] == {"name": "glue", "start": 0.3, "end": 0.0}
    assert made["posture"]["distance"]["value"] < 0.2
    assert np.abs(np.array(made["joints"][0]) - SHOWN_POSTURE[0]).max() < 0.2
    station, _ = path
    assert made["posture"]["demonstration"] in {d.id for d in station.demonstrations(TASK)}


def test_a_plan_may_choose_as_if_a_hand_had_shown_it(path: tuple[Station, str]) -> None:
    station, key = path
    free = station.plan(key, posture="free")
    assert (free.posture, free.output) == (None, None)
    assert np.abs(np.array(free.joints[0]) - SHOWN_POSTURE[0]).max() > 1.0


def test_joints_are_kept_with_the_samples(path: tuple[Station, str], desk: Desk) -> None:
    store = desk.station.store
    first = store.demonstrations(TASK)[0]
    joints = store.recordings.columns(first.recording, first.digest).joints
    assert np.abs(joints[RESTS:-RESTS] - SHOWN_POSTURE).max() < 0.01


@pytest.mark.parametrize(
    ("output", "said"),
    [({"name": "a/b"}, "tool output"), ({"name": "glue", "start": -1}, "greater than or equal to 0"), ({}, "name")],
)
def test_an_output_that_is_none_is_refused(path: tuple[Station, str], desk: Desk, output: object, said: str) -> None:
    refused(desk.post(f"/paths/{path[1]}/plans", {"output": output}), 422, said)


def test_only_plans_have_outputs(path: tuple[Station, str]) -> None:
    with pytest.raises(ClientError, match="output"):
        path[0].begin_job(TASK, "learn", output={"name": "glue"})
