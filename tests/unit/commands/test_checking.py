"""run --check judges by the arm that a signed plan names, else by the one that is configured."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.io.store.motions import MotionHeader, Motions
from teachpath.io.wire import encode_setpoint
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.signature import sign_plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan, Setpoint
from tests.unit.executor.executors import EPOCH, KEY
from tests.unit.motion.ways import MIDDLE, way

SLOW_SETTINGS = MotionSettings(variant="corke-1996", tool_speed=0.25)


def judged(file: Path, config: Path | None = None) -> str:
    """What the command prints, or the sentence with which it ends."""
    answer = CliRunner().invoke(app, ["run", "--check", str(file), *(["--config", str(config)] if config else [])])
    return answer.output if answer.exit_code == 0 else str(answer.exception)


@pytest.fixture(scope="module")
def slow() -> Plan:
    """A plan for another arm than the default one, with a limit of its speed."""
    return plan(way(MIDDLE), paper_scene(), SLOW_SETTINGS)


def setpoints(made: Plan) -> np.ndarray:
    return plan_trajectory(made).setpoints(250.0)[:, :6]


def test_a_csv_is_judged_by_the_configured_arm(tmp_path: Path, slow: Plan) -> None:
    log, config = tmp_path / "log.csv", tmp_path / "station.toml"
    joints = setpoints(slow)
    times = np.arange(len(joints)) * 0.004
    np.savetxt(log, np.column_stack([times, joints]), "%.17g", ",", header="t,q1,q2,q3,q4,q5,q6", comments="")
    assert "no limit is set" in judged(log)
    config.write_text("[motion]\ntool_speed = 0.2\n")
    assert "allowed 0.2 m/s (motion.tool_speed)" in judged(log, config)
    config.write_text('[motion]\nvariant = "corke-1996"\ntool_speed = 0.25\n')
    assert "keeps every limit" in judged(log, config)


def recorded(folder: Path, signed: Plan, parts: list[np.ndarray], *, from_rest: bool = False) -> Path:
    """Record setpoints; `from_rest` says of the first one of each part that the motion begins anew there."""
    still, stamp, cycle = np.zeros(6), EPOCH, -1
    take = Motions(folder).begin(MotionHeader("execution-1", "puma560", signed, way(MIDDLE)))
    for part in parts:
        for row, position in enumerate(part):
            stamp, cycle = stamp + 4_000_000, cycle + 1
            sent = Setpoint(cycle, stamp, stamp, position, still, still, True, "execution-1", on_path=True)
            take.write("setpoints", encode_setpoint(replace(sent, from_rest=from_rest and row == 0)), stamp)
    return take.finish({})


@pytest.fixture(scope="module")
def signed(slow: Plan) -> Plan:
    return sign_plan(slow, Arm.of_settings(SLOW_SETTINGS), SLOW_SETTINGS, KEY, issued_ns=EPOCH)


def test_a_recording_is_judged_by_the_arm_of_its_plan(tmp_path: Path, signed: Plan) -> None:
    file = recorded(tmp_path, signed, [setpoints(signed)])
    said = judged(file)  # by the default arm: millimetres off its path
    assert "allowed 0.25 m/s" in said
    assert "keeps every limit and the path" in said
    told = json.loads(CliRunner().invoke(app, ["run", "--check", str(file), "--json"]).stdout)
    assert (told["file"], told["faults"]) == (str(file), [])
    assert all(sentence in said for sentence in told["measured"])


def test_where_setpoints_came_late_a_recording_is_judged_from_rest_to_rest(tmp_path: Path, signed: Plan) -> None:
    whole = setpoints(signed)
    parts = [whole[: len(whole) // 2], whole]
    said = judged(recorded(tmp_path / "known", signed, parts, from_rest=True))
    assert "1 times setpoints were late and the arm came to rest by itself" in said
    assert "keeps every limit and the path" in said
    assert "breaks 4 of what it must keep" in judged(recorded(tmp_path / "silent", signed, parts))
