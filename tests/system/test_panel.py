"""The page beside live hands: who is there, what is recorded of them and thought of it, and the arm that they lead."""

import dataclasses
import json
import zipfile
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from teachpath.io.store.recording_facts import read_facts
from teachpath_client import Link, Tracker
from tests.system.access import barriers
from tests.system.operators import Leader, Shown
from tests.system.processes import Service
from tests.system.test_station import FAST_RATE, SAMPLE_COUNT, shown
from tests.system.visits import Visit
from tests.waiting import wait_until

pytestmark = pytest.mark.system


@pytest.fixture
def visit(browser: Any, service: Service) -> Iterator[Visit]:
    visit = Visit(browser, service.url)
    yield visit
    visit.page.close()


def until(visit: Visit, script: str) -> None:
    visit.page.wait_for_function(f"() => {script}", polling=20)


def text(id_: str) -> str:
    return f"document.getElementById('{id_}').textContent"


def test_a_tracker_that_comes_and_goes_is_shown(visit: Visit, service: Service) -> None:
    for _ in range(3):
        with Link(service.endpoint) as link:
            tracker = Tracker(link, "glove-page")
            until(visit, f"{text('recordings')}.includes('glove-page is here')")
        del tracker
        until(visit, f"!{text('recordings')}.includes('glove-page')")
    assert visit.said == []


def test_every_demonstration_has_its_verdict_and_what_is_wrong_with_it(visit: Visit, service: Service) -> None:
    bad = [dataclasses.replace(r, tracked=not 150 < i < 190) for i, r in enumerate(shown(1))]
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove-judged")
        tracker.start("judged", scene="paper")
        tracker.publish(shown(1), speed=FAST_RATE)
        tracker.stop()
        tracker.start("judged")
        tracker.publish(bad, speed=FAST_RATE)
        tracker.stop()
    visit.page.wait_for_selector("#task option[value=judged]", state="attached")
    visit.page.select_option("#task", "judged")
    until(visit, "document.querySelectorAll('#demonstrations .demonstration-list li').length === 2")
    newest, oldest = visit.page.locator("#demonstrations .demonstration-list li").all_inner_texts()
    assert "clean" in oldest
    assert "reject" in newest
    assert "lost sight of the hand" in newest
    folded = visit.page.locator("#demonstrations .demonstration-list li .why").first.text_content()
    assert "samples are faulty, " in folded
    for said, row in zip((oldest, newest), service.station.demonstrations("judged"), strict=True):
        facts = read_facts(service.data / "recordings" / row.recording)
        assert facts["verdict"] == row.verdict
        assert row.verdict in said
        account = json.loads(facts["statistics"])
        assert account == json.loads(json.dumps(asdict(row.statistics)))
        assert account["untracked"] == (39 if row.verdict == "reject" else 0)
    for mark in ("good", "bad", ""):
        visit.page.get_by_role("button", name=f"Mark demonstration 1 {mark or 'neither good nor bad'}").click()
        until(visit, f"{text('demonstrations')}.includes('Marked {mark}') === {str(bool(mark)).lower()}")
        assert [d.mark for d in service.station.demonstrations("judged")] == [mark, ""]
    visit.page.get_by_role("button", name="Discard the last").click()
    until(visit, "document.querySelectorAll('#demonstrations .demonstration-list li.discarded').length === 1")
    assert [bool(d.discarded_ns) for d in service.station.demonstrations("judged")] == [False, True]
    visit.page.get_by_role("button", name="Undo discard").click()
    until(visit, "document.querySelectorAll('#demonstrations .demonstration-list li.discarded').length === 0")
    until(visit, f"{text('demonstrations')}.includes('One demonstration so far; show it again.')")
    with visit.page.expect_download() as begun:
        visit.page.get_by_role("link", name="Download everything of this task").click()
    with zipfile.ZipFile(begun.value.path()) as archive:
        names = archive.namelist()
    assert len([name for name in names if name.endswith(".mcap")]) == 2  # also the rejected one
    assert any(name.endswith("SHA256SUMS") for name in names)
    assert visit.said == []


def test_a_recording_is_paused_and_resumed_from_the_page(visit: Visit, service: Service) -> None:
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove-paused")
        tracker.start("paused", scene="paper")
        visit.page.wait_for_selector("#task option[value=paused]", state="attached")
        visit.page.select_option("#task", "paused")
        visit.page.get_by_role("button", name="Pause").click()
        until(visit, f"{text('recordings')}.includes('Recording glove-paused: paused')")
        tracker.publish(shown(1), speed=FAST_RATE)
        wait_until(lambda: service.station.recordings("paused")[0].received == SAMPLE_COUNT, "all of it has come")
        visit.page.get_by_role("button", name="Resume").click()
        until(visit, f"{text('recordings')}.includes('Recording glove-paused: reach')")
        report = tracker.stop()
    assert (report.received, report.idle, len(report.demonstrations)) == (SAMPLE_COUNT, SAMPLE_COUNT, 0)
    assert visit.said == []


# a live hand


@pytest.fixture
def leader(visit: Visit, service: Service) -> Iterator[Leader]:
    """Somebody at the tab Run who leads the arm, and lets it go in the end."""
    visit.page.set_viewport_size({"width": 900, "height": 420})  # less to draw
    visit.page.locator("#tab-run").click()
    leader = Leader(visit, service.station)
    visit.page.locator("#teleop").scroll_into_view_if_needed()
    yield leader
    visit.page.locator("#teleop").get_by_role("button", name="Finish").click()
    leader.until(lambda status: status["state"] == "ended")
    assert leader.said == []


def test_the_arm_follows_the_page_s_hand_while_the_clutch_is_held(visit: Visit, leader: Leader) -> None:
    leader.begin()
    mouse, keys = visit.page.mouse, visit.page.keyboard
    begin = leader.tool()

    def ball() -> np.ndarray:
        return np.array(visit.page.evaluate("teachpath.teleop().handModel.position"))

    def press() -> None:
        mouse.move(*visit.project("teachpath.teleop().handModel.position"))
        mouse.down()

    def drag() -> None:
        x, y = visit.project("teachpath.teleop().handModel.position")
        mouse.move(x - 9, y + 6, steps=3)

    def there() -> bool:
        return np.linalg.norm(ball() - begin) > 0.03 and np.linalg.norm(leader.tool() - ball()) < 0.002

    visit.wait(lambda: visit.page.evaluate("teachpath.teleop().isPositioned"))
    assert barriers(visit.page, "leading the arm") == []
    leader.lead(press, drag, mouse.up, there)
    after = leader.tool_at_rest()
    mouse.move(500, 300, steps=3)  # nobody holds the clutch
    np.testing.assert_allclose(leader.tool_at_rest(), after, atol=0.002)

    def hold() -> None:
        visit.page.locator("#view").focus()
        keys.down("Enter")

    def let_go() -> None:
        keys.up("PageDown")
        keys.up("Enter")

    def lower_and_gripped() -> bool:
        if leader.tool()[2] > after[2] - 0.01:
            return False
        if not visit.page.evaluate("teachpath.teleop().handClosed"):
            keys.press("g")
        return bool(visit.page.evaluate("teachpath.teleop().gripperClosed")) and open_.is_visible()

    open_ = visit.page.get_by_role("button", name="Open the gripper")
    leader.lead(hold, lambda: keys.down("PageDown"), let_go, lower_and_gripped)


def test_the_page_holds_the_clutch_for_a_tracker_that_has_none(visit: Visit, service: Service, leader: Leader) -> None:
    button = visit.page.locator("#teleop").get_by_role("button", name="Clutch")
    with Link(service.endpoint) as link, Shown(link, "glove-led") as hand:
        leader.begin("glove-led")
        begin = np.zeros(3)

        def press() -> None:
            hand.place = (0.0, 0.0, 0.0)
            begin[:] = leader.tool()
            button.hover()
            visit.page.mouse.down()

        def move() -> None:
            hand.place = (0.0, 0.0, 0.05)

        leader.lead(press, move, visit.page.mouse.up, lambda: abs(leader.tool()[2] - begin[2] - 0.05) < 0.002)
        after = leader.tool_at_rest()
        hand.place = (0.0, 0.0, 0.0)
        np.testing.assert_allclose(leader.tool_at_rest(), after, atol=0.002)
