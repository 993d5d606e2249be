"""Run: what was shown by mouse and by a headset's hand is learned, certified, previewed, executed and steered."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath_client.models import Plan
from tests.system.access import barriers
from tests.system.carriers import HEADSET, begin, carry, carry_worn, move_hand, phase
from tests.system.operators import RESTING_STATES, Leader, Operator, Status, named_joints
from tests.system.processes import Service, stop_arm
from tests.system.visits import REST, Visit
from tests.waiting import wait_until

ARM = Arm.of_variant()

pytestmark = pytest.mark.system

TASK = "run-from-page"
ASSETS = Path(__file__).parent / "assets"


# Pressed and let go at once, whatever the page is busy with.
TAP = """() => {
  const button = document.querySelector("#arm button.hold");
  for (const name of ["pointerdown", "pointerup"]) button.dispatchEvent(new PointerEvent(name, { bubbles: true }));
}"""
SCRIPT = (ASSETS / "iwer" / "iwer.min.js").read_text() + HEADSET
SMALL_WINDOW, SMALLER_WINDOW = (900, 420), (900, 240)  # less to draw
Plans = list[Plan]  # one a way, in the order in which the ways were shown: by mouse, by the headset's hand


@pytest.fixture(scope="module")
def plans(browser: Any, service: Service) -> Plans:
    """What was shown twice by mouse and twice by a headset's hand, learned and certified: all in the page."""
    visit = Visit(browser, service.url, script=SCRIPT, size=SMALL_WINDOW)
    for size, button, show in (
        (SMALL_WINDOW, "Show it here", lambda _: carry(visit)),
        # No hand does the same twice: two that agree to the bit would make any other two look like two ways.
        (SMALLER_WINDOW, "In a headset", lambda nth: carry_worn(visit, move_hand, rise=0.24 + 0.005 * nth)),
    ):
        visit.page.set_viewport_size({"width": size[0], "height": size[1]})
        begin(visit, service, TASK, button=button)
        for nth in range(2):
            show(nth)
            phase(visit, "ready")
        visit.page.evaluate("teachpath.headset()?.end()")
        visit.page.get_by_role("button", name="Finish").click()
        visit.page.wait_for_selector("html[data-session='']", state="attached")
    visit.page.locator("#tab-ways").click()
    visit.page.get_by_role("button", name="Learn the ways").click()
    visit.page.wait_for_selector("#learned article.card")
    run = service.station.newest_run(TASK)
    assert run is not None
    learned = run.learned
    shown = [take.id for take in service.station.demonstrations(TASK)]
    members = sorted((set(cluster.members) for cluster in learned.clusters), key=lambda m: shown[0] not in m)
    assert members == [set(shown[:2]), set(shown[2:])]
    found = []
    for path in sorted(learned.paths, key=lambda path: shown[0] not in learned.clusters[path.cluster - 1].members):
        visit.page.get_by_role("button", name=f"Certify way {path.cluster}").click()
        visit.page.get_by_role("button", name=f"Run way {path.cluster}").wait_for()
        found += service.station.plans(path.id)[:1]
    visit.page.close()
    return found


@pytest.fixture
def visit(browser: Any, service: Service, plans: Plans) -> Iterator[Visit]:
    """A page of its own for every test."""
    visit = Visit(browser, service.url, script=SCRIPT, size=SMALL_WINDOW)
    yield visit
    visit.page.close()


def choose(visit: Visit, plan: Plan) -> None:
    """Go to the tab Run with the way that a plan is of."""
    visit.page.locator("#tab-ways").click()
    visit.page.locator(f"#learned [data-run='{plan.path}']").click()
    visit.wait(lambda: visit.page.evaluate("teachpath.state().plan?.id") == plan.id)


@pytest.fixture
def operator(visit: Visit, service: Service, plans: Plans) -> Iterator[Operator]:
    """Somebody at the tab Run, where the way shown by mouse is chosen; the arm rests afterwards."""
    choose(visit, plans[0])
    operator = Operator(visit, service.station)
    yield operator
    for one in operator.executions():
        if one.status.state not in RESTING_STATES:
            stop_arm(service.station, one.id)
    wait_until(lambda: all(one.status.state in RESTING_STATES for one in operator.executions()), "the arm rests")


def ghost(visit: Visit) -> np.ndarray:
    return np.array(visit.page.evaluate("teachpath.previewGhost()")).reshape(7, 4, 4).transpose(0, 2, 1)


def scrub(visit: Visit, seconds: float) -> None:
    slider = visit.page.get_by_label("Instant of the motion")
    slider.evaluate(f"s => {{ s.value = {seconds}; s.dispatchEvent(new Event('input')); }}")


def test_the_preview_is_the_plan_and_moves_no_arm(
    visit: Visit, service: Service, operator: Operator, plans: Plans
) -> None:
    executions = operator.executions()
    motion = service.station.preview(plans[0].id)
    visit.page.get_by_role("button", name="Preview", exact=True).click()
    visit.page.get_by_role("button", name="Pause").click()
    before = visit.place_at_rest("/robot/link6")
    times, joints = np.array(motion.times), np.array(motion.joints)
    for k in (0, len(times) // 3, len(times) // 2, len(times) - 1):
        scrub(visit, float(times[k]))
        shown = float(visit.page.get_by_label("Instant of the motion").input_value())  # the slider has steps
        q = np.array([np.interp(shown, times, column) for column in joints.T])
        np.testing.assert_allclose(ghost(visit), link_frames(q, ARM), atol=1e-6)
    words = visit.page.locator("#preview output").inner_text()
    assert "on the way home" in words
    np.testing.assert_allclose(visit.place("/robot/link6"), before, atol=2 * REST)
    assert operator.executions() == executions
    visit.page.get_by_role("button", name="Close preview").click()
    assert visit.page.evaluate("teachpath.previewGhost()") is None
    assert operator.said == []


def test_the_motion_is_taken_away_as_the_file_that_a_program_gets(
    visit: Visit, service: Service, operator: Operator, plans: Plans
) -> None:
    visit.page.get_by_text("Take it with you").click()
    with visit.page.expect_download() as begun:
        visit.page.get_by_role("button", name="Table (CSV)").click()
    assert begun.value.suggested_filename == f"{plans[0].id}.csv"
    assert begun.value.path().read_bytes() == service.station.program(plans[0].id)
    assert operator.said == []


def test_a_start_must_be_meant_and_the_path_is_gone_step_by_step_and_back(visit: Visit, operator: Operator) -> None:
    count = len(operator.executions())
    visit.page.wait_for_selector("button.hold:not([disabled])")
    visit.page.evaluate(TAP)
    visit.page.wait_for_timeout(1000)  # where it is not enough to show a fault, nothing fails
    assert len(operator.executions()) == count
    creep(visit, operator)
    hold(operator)
    state = visit.page.locator("#arm .state")
    visit.wait(lambda: state.inner_text().startswith("Held on the path: held by"))  # and why
    assert barriers(visit.page, "held") == []
    visit.page.get_by_role("slider", name="Speed").fill("30")
    operator.until(lambda status: status["override"] == pytest.approx(0.3))
    for name, way in (("+ 1 cm", 0.01), ("− 1 cm", -0.01), ("− 1 cm", -0.01)):
        length = operator.step(name, way)
    lengths = [length]

    def back(status: Status) -> bool:
        lengths.append(status["length"])
        return status["state"] == "held" and status["reason"].startswith("back at the beginning")

    operator.press("Reverse")
    assert operator.until(back, again="Reverse")["length"] == 0.0
    assert max(lengths) < lengths[0] + 1e-5  # where setpoints were late it goes back from where the arm came to rest
    operator.press("Resume")
    operator.until(lambda status: status["state"] == "following" and status["length"] > 0.0)
    assert operator.said == []


def creep(visit: Visit, operator: Operator) -> None:
    """Start, and go on along the path so slowly that its end is far, however late the next order comes."""
    speed = visit.page.get_by_role("slider", name="Speed")
    speed.fill("30")
    operator.start()
    assert operator.until(lambda status: status["length"] > 0.0)["override"] == pytest.approx(0.3)
    speed.fill("5")
    operator.until(lambda status: status["override"] == pytest.approx(0.05) and status["length"] > 0.03)


def hold(operator: Operator) -> Status:
    """Hold the arm where it is."""

    def held(status: Status) -> bool:
        if status["state"] in ("approaching", "following"):
            operator.try_to("Hold")
        return status["state"] == "held" and status["reason"].startswith("held by")

    return operator.until(held)


def test_the_space_bar_stops_the_arm_wherever_the_focus_is(visit: Visit, operator: Operator) -> None:
    creep(visit, operator)
    visit.page.locator("#tab-ways").focus()
    visit.page.keyboard.press("Space")
    status = operator.until(lambda status: status["state"] in RESTING_STATES)
    assert (status["state"], status["progress"] < 1.0) == ("ended", True), status["reason"]
    assert operator.said == []


def test_the_way_shown_by_a_headset_s_hand_is_run_to_its_goal(visit: Visit, operator: Operator, plans: Plans) -> None:
    choose(visit, plans[1])
    visit.page.get_by_role("slider", name="Speed").fill("100")
    operator.start()
    status = operator.until(lambda status: status["state"] in RESTING_STATES)
    assert (status["state"], status["progress"]) == ("ended", 1.0), status["reason"]
    assert operator.executions()[0].plan == plans[1].id
    assert operator.said == []


def test_a_past_execution_is_replayed_as_it_was(visit: Visit, service: Service, operator: Operator) -> None:
    operator.start()
    operator.until(lambda status: status["state"] in RESTING_STATES)
    last = operator.executions()[0]
    before = visit.place_at_rest("/robot/link6")
    visit.page.route("**/api/v1/robot", named_joints)
    visit.page.locator(f"#replay button[data-execution='{last.id}']").click()
    slider = visit.page.get_by_label("Instant of the execution")
    slider.wait_for()
    series = service.station.series(last.id, points=1500)
    times = np.array(series.times) - series.times[0]
    joints = np.array(series.positions)
    assert np.ptp(joints, axis=0).max() > 0.01
    for share in (0.0, 0.5, 1.0):
        slider.evaluate(f"s => {{ s.value = {share * times[-1]}; s.dispatchEvent(new Event('input')); }}")
        shown = min(float(slider.input_value()), times[-1])
        q = np.array([np.interp(shown, times, column) for column in joints.T])
        drawn = np.array(visit.page.evaluate("teachpath.replayGhost()")).reshape(7, 4, 4).transpose(0, 2, 1)
        np.testing.assert_allclose(drawn, link_frames(q, ARM), atol=1e-6)
    visit.wait(lambda: visit.page.locator("#replay .u-over").count() == 4)
    visit.page.locator("#replay summary").click()
    with visit.page.expect_download() as begun:
        visit.page.locator("#replay").get_by_role("button", name="Table (CSV)").click()
    assert begun.value.path().read_bytes() == service.station.executed_program(last.id)
    names = visit.page.locator("#replay .values dt").all_inner_texts()
    assert names[:6] == [f"axis {k}" for k in range(6)]  # as the arm's model has it
    np.testing.assert_allclose(visit.place("/robot/link6"), before, atol=2 * REST)
    assert operator.executions()[0].id == last.id
    visit.page.get_by_role("button", name="Close replay").click()
    assert visit.page.evaluate("teachpath.replayGhost()") is None
    assert operator.said == []


def test_control_is_taken_and_given_back(visit: Visit, service: Service, operator: Operator) -> None:
    visit.page.get_by_label("Your name").fill("anna")
    visit.page.get_by_role("button", name="Take control").click()
    visit.page.wait_for_selector("#arm button[data-word=release]")
    assert service.station.get_lease().holder == "anna"
    visit.page.get_by_role("button", name="Give it back").click()
    visit.page.wait_for_selector("#arm button[data-word=take]")
    assert service.station.get_lease().holder == ""
    assert operator.said == []


def test_the_joints_are_plotted_as_they_move(visit: Visit, operator: Operator) -> None:
    visit.page.wait_for_selector("#joints .values dd")
    visit.wait(lambda: visit.page.locator("#joints .u-over").count() == 4)
    names = visit.page.locator("#joints .values dt").all_inner_texts()
    assert names[:2] == ["joint 1", "joint 2"]
    assert operator.said == []


def test_a_headset_s_right_hand_leads_the_arm_while_the_left_one_is_closed(
    visit: Visit, service: Service, operator: Operator
) -> None:
    visit.page.evaluate("headset.primaryInputMode = 'hand'; 0")
    Leader(visit, service.station).lead_upwards()
    assert operator.said == []
