"""Run: a take shown by mouse, learned, planned, previewed as a ghost, executed and stopped from the page."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from teachpath.motion.kinematics import link_frames
from tests.system.carriers import begin, carry, phase
from tests.system.processes import Service, wait_until
from tests.system.test_view import Visit

pytestmark = pytest.mark.system

TASK = "run-from-page"
RESTING = ("idle", "ended", "faulted")


@pytest.fixture(scope="module")
def planned(browser: Any, service: Service) -> dict[str, Any]:
    """A task shown twice by mouse in the page, learned and planned."""
    visit = Visit(browser, service.url)
    visit.page.set_viewport_size({"width": 900, "height": 420})
    begin(visit, service, TASK)
    for _ in range(2):
        carry(visit)
        phase(visit, "ready")
    visit.page.get_by_role("button", name="Finish").click()
    visit.page.wait_for_selector("html[data-showing='']", state="attached")
    visit.page.close()
    learning = service.job(service.call("POST", f"/tasks/{TASK}/jobs", {"kind": "learn"})["id"], seconds=60)
    assert learning["state"] == "succeeded", learning["message"]
    run = service.call("GET", f"/tasks/{TASK}/runs/{learning['outcome']}")
    path = run["learned"]["paths"][0]["id"]
    planning = service.job(service.call("POST", f"/paths/{path}/plans", {})["id"], seconds=60)
    assert planning["state"] == "succeeded", planning["message"]
    plan: dict[str, Any] = service.call("GET", f"/plans/{planning['outcome']}")
    return plan


@pytest.fixture
def visit(browser: Any, service: Service, planned: dict[str, Any]) -> Iterator[Visit]:
    visit = Visit(browser, service.url)
    visit.page.set_viewport_size({"width": 900, "height": 420})
    visit.page.wait_for_selector(f"#task option[value={TASK}]", state="attached")
    visit.page.select_option("#task", TASK)
    visit.page.locator("#tab-run").click()
    yield visit
    visit.page.close()


def ghost(visit: Visit) -> np.ndarray:
    return np.array(visit.page.evaluate("teachpath.ghost()")).reshape(7, 4, 4).transpose(0, 2, 1)


def scrub(visit: Visit, seconds: float) -> None:
    slider = visit.page.get_by_label("Instant of the motion")
    slider.evaluate(f"s => {{ s.value = {seconds}; s.dispatchEvent(new Event('input')); }}")


def test_the_preview_is_the_plan_and_moves_no_arm(visit: Visit, service: Service, planned: dict[str, Any]) -> None:
    executions = service.call("GET", "/executions")
    motion = service.call("GET", f"/plans/{planned['id']}/motion")
    visit.page.get_by_role("button", name="Preview", exact=True).click()
    visit.page.get_by_role("button", name="Pause").click()
    before = visit.place("/robot/link6")
    times, joints = np.array(motion["times"]), np.array(motion["joints"])
    for k in (0, len(times) // 3, len(times) // 2, len(times) - 1):
        scrub(visit, float(times[k]))
        shown = float(visit.page.get_by_label("Instant of the motion").input_value())  # the slider has steps
        q = np.array([np.interp(shown, times, column) for column in joints.T])
        np.testing.assert_allclose(ghost(visit), link_frames(q), atol=1e-6)
    words = visit.page.locator("#preview output").inner_text()
    assert "on the way home" in words
    np.testing.assert_allclose(visit.place("/robot/link6"), before, atol=1e-5)
    assert service.call("GET", "/executions") == executions
    visit.page.get_by_role("button", name="Close preview").click()
    assert visit.page.evaluate("teachpath.ghost()") is None
    assert visit.said == []


def hold_start(visit: Visit, milliseconds: int) -> None:
    button = visit.page.get_by_role("button", name="Hold to start the arm")
    button.scroll_into_view_if_needed()
    box = button.bounding_box()
    assert box is not None
    visit.page.mouse.move(box["x"] + 20, box["y"] + box["height"] / 2)
    visit.page.mouse.down()
    visit.page.wait_for_timeout(milliseconds)
    visit.page.mouse.up()


def newest(service: Service) -> dict[str, Any]:
    found: dict[str, Any] = service.call("GET", "/executions")[0]
    return found


def test_a_start_must_be_meant_and_the_space_bar_stops(visit: Visit, service: Service) -> None:
    count = len(service.call("GET", "/executions"))
    visit.page.wait_for_selector("button.hold:not([disabled])")
    hold_start(visit, 200)
    visit.page.wait_for_timeout(800)
    assert len(service.call("GET", "/executions")) == count
    visit.page.get_by_role("slider", name="Speed").fill("30")
    hold_start(visit, 1000)
    wait_until(lambda: len(service.call("GET", "/executions")) > count, seconds=10, what="it begins")
    visit.page.wait_for_selector("#arm .dot.approaching, #arm .dot.following", timeout=20_000)
    assert newest(service)["status"]["override"] == pytest.approx(0.3)
    visit.page.get_by_role("button", name="Hold", exact=True).click()
    visit.page.wait_for_selector("#arm .dot.held", timeout=20_000)
    assert "Held on the path: " in visit.page.locator("#arm .state").inner_text()  # and why
    visit.page.get_by_role("button", name="Resume").click()
    visit.page.wait_for_selector("#arm .dot.held", state="detached", timeout=20_000)
    visit.page.locator("#tab-ways").focus()  # wherever the focus is
    visit.page.keyboard.press("Space")
    wait_until(lambda: newest(service)["status"]["state"] in RESTING, seconds=15, what="it stops")
    status = newest(service)["status"]
    assert (status["state"], status["progress"] < 1.0) == ("ended", True), status["reason"]
    assert visit.said == []


def test_a_past_execution_is_replayed_as_it_was(visit: Visit, service: Service) -> None:
    last = newest(service)  # the one that was stopped
    assert last["status"]["state"] in RESTING
    before = visit.place("/robot/link6")
    visit.page.locator("#replay li button").first.click()
    slider = visit.page.get_by_label("Instant of the execution")
    slider.wait_for()
    series = service.call("GET", f"/executions/{last['id']}/series?points=1500")
    times = np.array(series["times"]) - series["times"][0]
    joints = np.array(series["positions"])
    assert np.abs(joints[0] - joints[-1]).max() > 0.01
    for share in (0.0, 0.5, 1.0):
        slider.evaluate(f"s => {{ s.value = {share * times[-1]}; s.dispatchEvent(new Event('input')); }}")
        shown = min(float(slider.input_value()), times[-1])
        q = np.array([np.interp(shown, times, column) for column in joints.T])
        drawn = np.array(visit.page.evaluate("teachpath.replayed()")).reshape(7, 4, 4).transpose(0, 2, 1)
        np.testing.assert_allclose(drawn, link_frames(q), atol=1e-6)
    assert visit.page.locator("#replay .u-over").count() == 4
    np.testing.assert_allclose(visit.place("/robot/link6"), before, atol=1e-5)
    assert newest(service)["id"] == last["id"]
    visit.page.get_by_role("button", name="Close replay").click()
    assert visit.page.evaluate("teachpath.replayed()") is None
    assert visit.said == []


def test_control_is_taken_and_given_back(visit: Visit, service: Service) -> None:
    visit.page.get_by_label("Your name").fill("anna")
    visit.page.get_by_role("button", name="Take control").click()
    visit.page.wait_for_selector("#arm button[data-word=release]")
    assert service.call("GET", "/lease")["holder"] == "anna"
    visit.page.get_by_role("button", name="Give it back").click()
    visit.page.wait_for_selector("#arm button[data-word=take]")
    assert service.call("GET", "/lease")["holder"] == ""
    assert visit.said == []


def test_the_joints_are_plotted_as_they_move(visit: Visit) -> None:
    visit.page.wait_for_selector("#joints .values dd")
    assert visit.page.locator("#joints .u-over").count() == 4
    names = visit.page.locator("#joints .values dt").all_inner_texts()
    assert names[:2] == ["joint 1", "joint 2"]
    assert visit.said == []
