"""What the view shows: turned by the keyboard, near the chosen way, and all of an arm whose base is high."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from tests.system.visits import Server, Visit, way

pytestmark = pytest.mark.system

BASE = ((0.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))
STRETCHED_ARM = np.zeros(6)  # [rad] upright, as high as the arm reaches


@pytest.fixture
def server() -> Iterator[Server]:
    server = Server()
    server.start(demonstrations=3)
    yield server
    server.stop()


def shares(visit: Visit, points: Any) -> np.ndarray:
    """Where points (n, 3) are in the view (n, 2), from 0 at its left and upper edge to 1."""
    visit.page.wait_for_function("() => teachpath.framed()", polling=20)
    seen = visit.page.evaluate(f"{np.asarray(points).tolist()}.map((p) => teachpath.project(p))")
    box = visit.page.locator("#view").bounding_box()
    assert box is not None
    return (np.array(seen) - [box["x"], box["y"]]) / [box["width"], box["height"]]


def is_inside(seen: np.ndarray) -> bool:
    return bool((seen > 0).all() and (seen < 1).all())


def test_the_view_is_turned_by_the_keyboard_and_shows_a_high_arm_wholly(browser: Any, server: Server) -> None:
    visit, course = Visit(browser, server.address), way(1).curve(np.linspace(0, 1, 30))
    keys, middle = visit.page.keyboard, course.mean(axis=0)
    begin = shares(visit, course)
    visit.page.locator("#view").focus()
    keys.press("ArrowLeft")
    assert np.abs(shares(visit, course) - begin).max() > 0.01
    keys.press("ArrowRight")
    np.testing.assert_allclose(shares(visit, course), begin, atol=0.001)
    keys.press("3")  # from above: what is higher is in the same place
    at, ahead, _, higher = shares(visit, [middle, *(middle + 0.1 * np.eye(3))])
    assert np.linalg.norm(higher - at) < 0.3 * np.linalg.norm(ahead - at)
    keys.press("f")
    seen = shares(visit, course)
    assert is_inside(seen)
    assert np.ptp(seen, axis=0).max() > 0.6
    keys.press("0")
    np.testing.assert_allclose(shares(visit, course), begin, atol=0.001)
    assert visit.page.evaluate("teachpath.stand()") == 0  # this arm stands on the floor

    arm = Arm.of_model(read_arm("six-axis", base=BASE, gripper_length=0.13), MotionSettings())
    server.stop()
    server.start(demonstrations=3, arm=arm, home=STRETCHED_ARM)
    visit.wait(lambda: len([p for p in visit.paths() if p.startswith("/robot/link")]) == len(visual_solids(arm)))
    visit.wait(lambda: visit.page.evaluate("teachpath.stand()") == pytest.approx(BASE[0][2]))
    keys.press("0")
    assert is_inside(shares(visit, link_frames(STRETCHED_ARM, arm)[:, :3, 3]))
    visit.page.close()
