"""Which motions leave a station as files."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.errors import NotFound, PathRefused, UnusableInput
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.setpoints import read_setpoints
from teachpath.io.store.motions import MotionHeader, Motions
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_setpoint
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.settings import MotionSettings
from teachpath.records import Job, JobState, Plan
from teachpath.robot.executions import Executions
from teachpath.robot.programs import Programs, write_execution
from tests.unit.executor.executors import EPOCH, KEY, KEYS, MOTION, signed
from tests.unit.motion.analysis.test_sampled_execution import setpoints

DAY_NS = 86_400 * 10**9


def call(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


def programs(store: Store, *, motion: MotionSettings = MOTION, now: int = EPOCH) -> Programs:
    executions = Executions(MemoryBus(), KEYS, store, lambda entry: None, robot="puma560")
    return Programs(store, KEY, motion, Arm.of_settings(motion), executions, call, lambda: now)


def keep(store: Store, plan: Plan) -> None:
    store.ensure_task("t", scene="paper", calibration="identity")
    store.add_job(Job(f"job-{plan.id}", "t", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0))
    store.finish_planning(f"job-{plan.id}", plan)


def test_a_certified_plan_leaves_at_any_rate(store: Store, middle: Plan) -> None:
    keep(store, middle)
    for rate in (None, 97.0):
        file = programs(store).of_plan(middle.id, "csv", rate)
        assert file.name == f"{middle.id}.csv"
        times, positions, _ = read_setpoints(file.content, file.name)
        assert 1 / (times[1] - times[0]) == pytest.approx(rate or 250.0)
        np.testing.assert_allclose(positions, plan_trajectory(middle)(times)[:, :6], rtol=0, atol=1e-12)


def test_a_plan_whose_certificate_does_not_hold_stays(store: Store, middle: Plan) -> None:
    keep(store, middle)
    late = EPOCH + 31 * DAY_NS
    unsigned = replace(middle, id="unsigned", certificate=replace(middle.certificate, signature=None))
    keep(store, unsigned)
    changed = replace(middle, id="changed", joints=middle.joints + 1e-9)
    keep(store, changed)
    for plan, station, sentence in (
        (middle, programs(store, now=late), "expired 1.00 days ago"),
        (middle, programs(store, motion=replace(MOTION, clearance_min=0.02)), "holds for motion.clearance_min"),
        (unsigned, programs(store), "is not signed"),
        (changed, programs(store), "is not one of this station's"),
    ):
        with pytest.raises(PathRefused, match=sentence):
            station.of_plan(plan.id, "csv", None)


def test_a_revoked_plan_stays(store: Store, middle: Plan) -> None:
    keep(store, middle)
    store.journal.revoke(middle.id, who="ann", reason="the table was moved")
    with pytest.raises(PathRefused, match="was revoked: the table was moved; plan the path again"):
        programs(store).of_plan(middle.id, "json", None)


def test_what_cannot_be_written_is_a_sentence(store: Store, middle: Plan) -> None:
    keep(store, middle)
    station = programs(store)
    for plan, format, rate, kind, sentence in (
        ("moon", "csv", None, NotFound, "moon"),
        (middle.id, "xls", None, UnusableInput, "no format 'xls'"),
        (middle.id, "csv", 0.0, UnusableInput, "a rate of 0 Hz"),
        (middle.id, "csv", float("nan"), UnusableInput, "a rate of nan Hz"),
        (middle.id, "csv", 1e9, UnusableInput, r"a rate of 1e\+09 Hz"),
    ):
        with pytest.raises(kind, match=sentence):
            station.of_plan(plan, format, rate)
    with pytest.raises(NotFound, match="moon"):
        station.of_execution("moon", "csv", None)
    with pytest.raises(
        UnusableInput, match="a program in rapid moves a robot, so it is made of a certified plan alone"
    ):
        station.of_execution("moon", "rapid", None)


def test_an_execution_leaves_as_it_was_recorded(tmp_path: Path, middle: Plan) -> None:
    sent = setpoints(100)
    take = Motions(tmp_path).begin(MotionHeader("execution-1", "puma560", signed(middle)))
    for setpoint in sent:
        take.write("setpoints", encode_setpoint(setpoint), setpoint.nominal_ns)
    content = write_execution(take.finish({}), "execution-1", "json", 250.0, Arm.of_variant())
    document = json.loads(content)
    assert f"Execution execution-1: the 100 setpoints that were sent to follow plan {middle.id}." in document["notes"]
    points = document["joint_trajectory"]["points"]
    np.testing.assert_allclose([p["positions"] for p in points], [s.position for s in sent], rtol=0, atol=1e-12)
