"""What `import teachpath` offers: the menu, and the way from arrays to a certified plan and its setpoints."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import teachpath
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.signature import sign_plan
from teachpath.motion.settings import MotionSettings
from tests.unit.executor.executors import EPOCH, KEY
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()

ROOT = Path(__file__).parents[2]
U = np.sin(np.linspace(0.0, np.pi / 2, 120))[:, None] ** 2


def shown(height: float) -> np.ndarray:
    return np.array([0.55, -0.25, 0.60]) + U * [0.0, 0.5, 0.0] + np.sin(np.pi * U) * [0.0, 0.0, height]


@pytest.fixture(scope="module")
def learned() -> teachpath.Learned:
    return teachpath.learn([shown(height) for height in (0.10, 0.11, 0.12)])


@pytest.fixture(scope="module")
def plan(learned: teachpath.Learned) -> teachpath.Plan:
    return teachpath.plan(learned.paths[0])


# the menu


def test_the_menu_is_complete_and_all_of_it_is_there() -> None:
    assert set(dir(teachpath)) == {*teachpath.__all__, "__version__"}
    assert sorted(teachpath.__all__) == teachpath.__all__
    for name in teachpath.__all__:
        assert getattr(teachpath, name).__doc__
    errors = {
        name
        for name, value in vars(teachpath.errors).items()
        if isinstance(value, type) and issubclass(value, Exception)
    }
    assert errors <= {*teachpath.__all__}


def test_what_is_not_on_the_menu_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'lern'"):
        teachpath.lern  # type: ignore[attr-defined]  # noqa: B018


def test_other_programs_see_the_types() -> None:
    for folder in ("service/teachpath", "clients/teachpath_client", "proto/teachpath_proto"):
        assert (ROOT / folder / "py.typed").is_file()


# from arrays to setpoints


def test_the_readme_s_lines_run() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert len(code.splitlines()) <= 12
    ended = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert re.fullmatch(r"\d\.\d\d s, nearest: .*\n", ended.stdout)


def test_the_example_learns_two_ways_and_plans_one(tmp_path: Path) -> None:
    example = ROOT / "clients" / "examples" / "00_learn_and_plan_in_python.py"
    command = [sys.executable, "-W", "error", str(example), "--setpoints", str(tmp_path / "setpoints.csv")]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert re.findall(r"^way (\d)", ended.stdout, re.MULTILINE) == ["1", "2"]
    assert "certified: " in ended.stdout
    assert "refused: wrist centre" in ended.stdout
    assert np.loadtxt(tmp_path / "setpoints.csv", delimiter=",").shape[1] == 7


def test_rows_and_tables_and_names_learn_the_same_path(learned: teachpath.Learned) -> None:
    table = {axis: shown(0.12)[:, k] for k, axis in enumerate("xyz")} | {"t": 0.02 * np.arange(120)}
    again = teachpath.learn({"1": shown(0.10).tolist(), "2": shown(0.11), "3": table})
    assert again.inputs == learned.inputs
    np.testing.assert_array_equal(again.paths[0].curve.control_points, learned.paths[0].curve.control_points)


def test_setpoints_follow_the_path_within_the_limits(plan: teachpath.Plan) -> None:
    rate = 250.0
    times, joints = teachpath.setpoints(plan, rate)
    np.testing.assert_allclose(np.diff(times), 1 / rate)
    assert plan.duration <= times[-1] < plan.duration + 1 / rate
    np.testing.assert_allclose(joints[[0, -1]], plan.joints[[0, -1]], atol=1e-9)
    assert ((joints >= ARM.limits.lower) & (joints <= ARM.limits.upper)).all()
    assert (np.abs(np.diff(joints, axis=0)) * rate <= ARM.limits.speed).all()
    assert (np.abs(np.diff(joints, 2, axis=0)) * rate**2 <= ARM.limits.acceleration * (1 + 1e-9)).all()


def test_a_curve_of_one_s_own_is_planned_and_what_is_carried_is_fetched() -> None:
    plan = teachpath.plan(way(MIDDLE).curve, paper_scene())
    assert plan.scene.carried is not None
    assert plan.certificate.clearance.value > 0


def test_an_empty_scene_and_the_defaults_are_taken_when_nothing_is_said(plan: teachpath.Plan) -> None:
    assert plan.scene.name == "empty"
    assert teachpath.MotionSettings() == teachpath.MotionSettings()


# what cannot be


def test_a_town_is_not_learned_nor_planned() -> None:
    with pytest.raises(teachpath.UnusableInput, match=r"demonstration 1: row 0 .* farther than 10 m from the robot"):
        teachpath.learn([2000 * shown(0.1)])
    with pytest.raises(teachpath.PathRefused, match="outside the reach at s = "):
        teachpath.plan(replace(way(MIDDLE).curve, control_points=10 * way(MIDDLE).curve.control_points))


def test_too_short_and_too_still_is_refused_by_name() -> None:
    with pytest.raises(teachpath.LearningFailed, match="demonstration 2 has 3 distinct points, needs 5") as failed:
        teachpath.learn([shown(0.1), shown(0.1)[::20][:3]])
    assert failed.value.demonstration == "2"
    one = teachpath.learn([shown(0.1), shown(0.1)[:3]])  # one that does not move keeps nobody from learning
    assert one.notes == ("demonstration 2 moves only 0.41 mm, needs 1 mm and is left out",)
    with pytest.raises(teachpath.LearningFailed, match="demonstration still has 1 distinct points"):
        teachpath.learn({"still": np.ones((50, 3))})
    with pytest.raises(teachpath.LearningFailed, match="no demonstration to learn from"):
        teachpath.learn([])


def test_what_is_no_path_is_refused_with_the_way_out(learned: teachpath.Learned) -> None:
    with pytest.raises(
        teachpath.UnusableInput, match=r"these are 1 paths; plan one of them, e\.g\. learned\.paths\[0\]"
    ):
        teachpath.plan(learned)  # type: ignore[arg-type]
    with pytest.raises(teachpath.UnusableInput, match=r"not ndarray; make one: learn\(\[points\]\)\.paths\[0\]"):
        teachpath.plan(shown(0.1))  # type: ignore[arg-type]


def test_a_plan_that_was_changed_gives_no_setpoints(plan: teachpath.Plan) -> None:
    with pytest.raises(teachpath.PathRefused, match="has changed since it was certified"):
        teachpath.setpoints(replace(plan, joints=plan.joints + 0.01))
    with pytest.raises(teachpath.UnusableInput, match="a rate of 0 Hz is outside 1 to 10000"):
        teachpath.setpoints(plan, 0.0)


def test_a_plan_is_of_its_arm_and_no_other(plan: teachpath.Plan, learned: teachpath.Learned) -> None:
    other = teachpath.Arm.of_variant("corke-1996")
    made = teachpath.plan(learned.paths[0], arm=other)
    assert made.certificate.digest != plan.certificate.digest
    assert len(teachpath.setpoints(made, arm=other)[0])
    settings = MotionSettings(variant="corke-1996", grasp_depth=0.012, tool_speed=0.3)
    configured = teachpath.plan(learned.paths[0], settings=settings)
    assert len(teachpath.setpoints(configured, settings=settings)[0])
    signed = sign_plan(configured, teachpath.Arm.of_settings(settings), settings, KEY, issued_ns=EPOCH)
    assert len(teachpath.setpoints(signed)[0])  # its signature names the arm
    longer = replace(other, tool_length=other.tool_length + 0.01)
    for wrong in (None, longer):
        with pytest.raises(teachpath.PathRefused, match="another arm"):
            teachpath.setpoints(made, arm=wrong)
