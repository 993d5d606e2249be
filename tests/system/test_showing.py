"""Show it here: demonstrations carried in the page by mouse, keyboard and headset, on a running service."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.system.carriers import (
    GOAL,
    HEADSET,
    HEAR_SCRIPT,
    START,
    begin,
    carry_worn,
    finish,
    has_no_gaps,
    is_judged_by_its_frames,
    move_controller,
    move_hand,
    phase,
    until_box,
)
from tests.system.operators import Operator
from tests.system.processes import Service
from tests.system.stories import Fingers, Mouse, tell
from tests.system.visits import Visit
from tests.waiting import wait_until

LOW_HEIGHT = START[2] + 0.05  # [m]
SIZE = (900, 420)  # which leaves the machine to the sampling
MOST_ACTS = 12  # from the first press to the first motion
ASSETS = Path(__file__).parent / "assets"

pytestmark = pytest.mark.system

# A gamepad that the tests hold: standard mapping, plugged in when `pad.connected` is set.
GAMEPAD = """
globalThis.pad = {connected: false, axes: [0, 0, 0, 0], buttons: Array.from({length: 17}, () => ({pressed: false}))};
navigator.getGamepads = () => [pad];
"""


@pytest.fixture(scope="module")
def visit(browser: Any, service: Service) -> Iterator[Visit]:
    visit = Visit(browser, service.url, script=GAMEPAD, size=SIZE)
    yield visit
    visit.page.close()


def test_the_whole_story_is_told_by_mouse_and_takes_are_discarded_and_brought_back(
    visit: Visit, service: Service
) -> None:
    begin(visit, service, "by-mouse")
    hand = Mouse(visit, actions=1)
    for _ in range(2):
        hand.show()
    takes = service.station.demonstrations("by-mouse")
    words = [take.verdict for take in takes]
    shown = visit.page.locator("#demonstration-session .demonstration-list li .verdict")
    wait_until(lambda: shown.all_inner_texts() == words, "the page shows the verdicts of both takes")
    for take in takes:  # a machine that is too busy for the declared rate makes it a repaired one
        assert take.verdict in ("clean", "repaired"), take.reasons
        assert has_no_gaps(take)
    goal = service.station.trajectory(takes[0].id).positions[-1]
    assert math.dist(goal, GOAL) < 0.05
    visit.page.get_by_role("button", name="Discard the take").click()
    visit.page.wait_for_selector("#demonstration-session .demonstration-list li.discarded")
    assert [bool(take.discarded_ns) for take in service.station.demonstrations("by-mouse")] == [False, True]
    visit.page.get_by_role("button", name="Undo", exact=True).click()
    visit.page.wait_for_selector("#demonstration-session .demonstration-list li.discarded", state="detached")
    operator = Operator(visit, service.station)
    assert tell(hand, operator) <= MOST_ACTS
    assert service.station.recordings("by-mouse") == []
    assert operator.said == []


def test_a_take_by_keyboard(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-keys")
    keys = visit.page.keyboard
    keys.press("Enter")
    phase(visit, "carrying")
    far = f"Math.hypot(at[0] - {START[0]}, at[1] - {START[1]}) > 0.1"
    for key, there in (
        ("PageUp", f"at[2] > {START[2] + 0.1}"),
        ("ArrowLeft", far),
        ("PageDown", f"at[2] < {LOW_HEIGHT}"),
    ):
        keys.down(key)
        until_box(visit, there)
        keys.up(key)
    keys.press("Enter")
    phase(visit, "ready")
    finish(visit)
    was_carried(service, "by-keys")


def was_carried(service: Service, task: str, takes: int = 1) -> None:
    made = service.station.demonstrations(task)
    assert len(made) == takes
    for take in made:
        assert take.verdict != "reject", take.reasons
        assert has_no_gaps(take)
        ways = service.station.trajectory(take.id).positions
        assert max(z for _, _, z in ways) > START[2] + 0.05
        assert math.dist(ways[-1][:2], START[:2]) > 0.05


def test_a_take_by_gamepad(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-pad")
    visit.page.evaluate("pad.connected = true; pad.buttons[0].pressed = true; 0")
    phase(visit, "carrying")
    far = f"Math.hypot(at[0] - {START[0]}, at[1] - {START[1]}) > 0.1"
    # the right stick up, then the left one to the left
    for axes, there in (("0, 0, 0, -1", f"at[2] > {START[2] + 0.1}"), ("-1, 0.1, 0, 0", far)):
        visit.page.evaluate(f"pad.axes = [{axes}]; 0")
        until_box(visit, there)
    visit.page.evaluate("pad.axes = [0, 0, 0, 0]; pad.buttons[0].pressed = false; 0")
    phase(visit, "ready")
    visit.page.evaluate("pad.connected = false; 0")
    finish(visit)
    was_carried(service, "by-pad")


def test_the_whole_story_is_told_by_fingers_on_a_phone(visit: Visit, service: Service) -> None:
    visit.page.set_viewport_size({"width": 390, "height": 844})
    begin(visit, service, "by-touch")
    hand, operator = Fingers(visit, actions=1), Operator(visit, service.station)
    for _ in range(2):
        hand.show()
    assert tell(hand, operator) <= MOST_ACTS
    was_carried(service, "by-touch", takes=2)
    assert operator.said == []
    visit.page.set_viewport_size({"width": SIZE[0], "height": SIZE[1]})


def test_a_hidden_page_stops_and_throws_away_what_was_carried(visit: Visit, service: Service) -> None:
    begin(visit, service, "hidden")
    visit.page.keyboard.press("Enter")
    phase(visit, "carrying")
    sent = visit.page.evaluate("teachpath.session().sender.sequence")
    visit.wait(lambda: visit.page.evaluate("teachpath.session().sender.sequence") > sent + 30)
    hide = "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
    visit.page.evaluate(hide + "document.dispatchEvent(new Event('visibilitychange'))")
    visit.page.wait_for_selector("#message p.error")
    assert "The page was hidden" in visit.page.locator("#message").inner_text()
    assert service.station.recordings("hidden") == []
    assert service.station.demonstrations("hidden") == []
    visit.page.evaluate("delete document.hidden")


@pytest.fixture
def worn(browser: Any, service: Service) -> Iterator[Visit]:
    script = (ASSETS / "iwer" / "iwer.min.js").read_text() + HEADSET
    visit = Visit(browser, service.url, script=script, size=(900, 240))  # the frames of a headset are drawn, too
    yield visit
    visit.page.close()


PICTURES = """async ([cost, frames]) => {
  const { FrameSkipper } = await import("/web/hand/frame_skipping.js");
  const pictures = new FrameSkipper();
  let [time, drawn] = [0, false];
  return frames.map((busy) => {
    time += drawn ? cost : 11;
    drawn = pictures.shouldRender(time, busy);
    return [time, drawn];
  });
}"""


@pytest.mark.parametrize("cost", [11, 60, 340])
def test_pictures_never_tear_a_hole_into_a_take_and_come_back_after_it(visit: Visit, cost: int) -> None:
    before, take, after = 200, 600, 2000
    busy = [*[False] * before, *[True] * take, *[False] * after]
    times, drawn = np.array(visit.page.evaluate(PICTURES, [cost, busy])).T
    shown = np.flatnonzero(drawn)
    during = np.count_nonzero((shown >= before) & (shown < before + take))
    assert during == {11: take, 340: 0}.get(cost, during)
    assert {11: after, 60: 30, 340: 1}[cost] <= np.count_nonzero(shown >= before + take)
    if cost == 60:  # it may be drawn, but seldom enough that most frames are in time
        assert np.mean(np.diff(times[before : before + take]) > 40) < 0.1


def test_takes_by_an_emulated_hand_and_a_controller_in_one_headset(worn: Visit, service: Service) -> None:
    worn.page.evaluate(HEAR_SCRIPT)
    begin(worn, service, "by-headset", button="In a headset")
    carry_worn(worn, move_hand)
    phase(worn, "ready")
    worn.page.evaluate("headset.primaryInputMode = 'controller'; 0")
    carry_worn(worn, move_controller)
    phase(worn, "ready")
    frames, samples = worn.page.evaluate("[teachpath.headset().frames, teachpath.headset().samples]")
    assert frames == samples > 100
    worn.page.evaluate("teachpath.headset().end()")
    heard = np.array(worn.page.evaluate("heard"), dtype=float)  # the last take goes on to the last sample
    worn.page.get_by_role("button", name="Finish").click()
    worn.page.wait_for_selector("html[data-session='']", state="attached")
    by_hand, by_controller = service.station.demonstrations("by-headset")
    for take in (by_hand, by_controller):
        is_judged_by_its_frames(take, heard)
        assert has_no_gaps(take)
        ways = service.station.trajectory(take.id)
        assert len(ways.orientations or []) == len(ways.positions)
        assert math.dist(ways.positions[0], START) < 1e-6
        assert math.dist(ways.positions[-1], GOAL) < 0.05
    assert worn.said == []


def test_without_a_headset_the_page_says_why(visit: Visit) -> None:
    assert visit.page.get_by_role("button", name="In a headset").is_disabled()
    assert "No headset is connected" in visit.page.locator("#demonstration-session").inner_text()
