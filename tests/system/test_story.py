"""The whole story in the page, on what the demo leaves: choose a way, edit it, certify it, run it, look at it again."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.io.store.motions import read_motion
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath_client.station import Station
from tests.system.demos import Start, assert_nothing_left, assert_story
from tests.system.editors import Desk
from tests.system.operators import RESTING_STATES, Operator
from tests.waiting import wait_until

ARM = Arm.of_variant()

pytestmark = pytest.mark.system

NEAR_DISTANCE = 0.001  # [m] from the setpoints on the path to the nearest of the places of it that are compared


def test_what_the_demo_has_learned_is_edited_certified_run_and_replayed(
    browser: Any, start: Start, tmp_path: Path
) -> None:
    demo = start("--json", "--speed", "20")
    wait_until(lambda: "stays up" in demo.err or demo.process.poll(), "the story ends")
    assert_story(demo.out)
    found = re.search(r"serves (http://[0-9.]+:[0-9]+)", demo.err)
    assert found is not None, demo.err
    with Station(found[1]) as station:
        tell(browser, found[1], station, tmp_path)
    assert any("[executor]" in line for line in demo.relatives())
    demo.interrupt()
    assert demo.wait() == 0
    assert "Traceback" not in demo.err
    assert_nothing_left(demo)


def tell(browser: Any, url: str, station: Station, tmp_path: Path) -> None:
    """Go through the page as its user does."""
    desk = Desk(browser, url)
    desk.click("#tab-ways")
    desk.page.wait_for_selector("#learned article.card >> nth=2")
    assert desk.page.locator("#learned article.card").count() == 3
    desk.page.get_by_role("button", name="Edit way 2").click()
    desk.until("editor.draft && teachpath.state().path === editor.draft.path")
    path = desk.ask("editor.draft.path")
    desk.drag(3, 6, -6)
    desk.until("editor.feasibility.assessment && editor.feasibility.curve === editor.draft.curve")
    assert desk.page.locator("#edit-feasibility .good").count() == 1
    desk.save()
    desk.until("editor.draft.base.number === 2")
    edited = desk.curve()
    desk.click("#edit-certify")
    desk.page.wait_for_selector("#edit-run")
    assert "Version 2 is certified" in desk.page.inner_text("#edit-certified")
    desk.click("#edit-run")
    desk.page.wait_for_selector("#preview:has-text('Way 2, version 2')")
    operator = Operator(desk, station)
    operator.start()
    status = operator.until(lambda status: status["state"] in RESTING_STATES)
    assert (status["state"], status["progress"]) == ("ended", 1.0), status["reason"]
    done = operator.executions()[0]
    plan = station.get_plan(done.plan or "")
    assert (plan.path, plan.path_version) == (path, 2)
    desk.page.locator(f"#replay button[data-execution='{done.id}']").click()
    slider = desk.page.get_by_label("Instant of the execution")
    slider.wait_for()
    desk.until("teachpath.replayGhost() !== null")
    series = station.series(done.id, points=1500)
    file = tmp_path / "execution.mcap"
    file.write_bytes(station.recorded_execution(done.id))
    followed = np.array([setpoint.position for setpoint in read_motion(file).setpoints if setpoint.on_path])
    places, fine = tool_pose(followed, ARM)[:, :3, 3], edited(np.linspace(0, 1, 1001))
    apart = np.array([np.linalg.norm(fine - place, axis=1).min() for place in places])
    assert apart.max() < NEAR_DISTANCE, apart.max()
    assert np.linalg.norm(places[[0, -1]] - fine[[0, -1]], axis=1).max() < NEAR_DISTANCE
    shown = float(slider.get_attribute("max") or 0)  # what was written when it was opened
    assert plan.duration < shown <= series.times[-1] - series.times[0] + 1e-6
    desk.close()
