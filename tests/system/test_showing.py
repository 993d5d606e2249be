"""Show it here: demonstrations carried in the page by mouse, keyboard and headset, on a running service."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.system.processes import Service
from tests.system.test_view import Visit

ASSETS = Path(__file__).parent / "assets"

pytestmark = pytest.mark.system

START, GOAL = (0.58, -0.28, 0.52), (0.58, 0.28, 0.52)  # of the box in the paper's scene
OVER = 0.62  # [m] height at which it is carried between the obstacles


# A gamepad that the tests hold: standard mapping, plugged in when `pad.connected` is set.
GAMEPAD = """
globalThis.pad = {connected: false, axes: [0, 0, 0, 0], buttons: Array.from({length: 17}, () => ({pressed: false}))};
navigator.getGamepads = () => [pad];
"""


@pytest.fixture(scope="module")
def visit(browser: Any, service: Service) -> Iterator[Visit]:
    """One page for the tests; each of them finishes its sitting."""
    visit = Visit(browser, service.url, script=GAMEPAD)
    # Without a graphics card every pixel costs: a small view leaves the machine to the sampling.
    visit.page.set_viewport_size({"width": 900, "height": 420})
    visit.page.wait_for_timeout(300)
    yield visit
    visit.page.close()


def phase(visit: Visit, name: str, seconds: float = 15.0) -> None:
    visit.page.wait_for_selector(f"html[data-showing={name}]", state="attached", timeout=1000 * seconds)


def begin(visit: Visit, service: Service, task: str, button: str = "Show it here") -> None:
    """Choose a new task of the paper's scene and begin to show it, without countdown."""
    service.call("PUT", f"/tasks/{task}", {"scene": "paper"})
    visit.page.wait_for_selector(f"#task option[value={task}]", state="attached")
    visit.page.select_option("#task", task)
    visit.page.locator("#tab-demonstrate").click()
    visit.page.get_by_label("Countdown").select_option("0")
    visit.page.get_by_role("button", name=button).click()
    phase(visit, "ready")


def carry(visit: Visit, *, way: float = 0.0) -> None:
    """Press on the box, lift it with the wheel, carry it between the obstacles, lower it and let go."""
    mouse = visit.page.mouse
    at = tuple(visit.page.evaluate(f"teachpath.project({list(START)})"))
    mouse.move(*at)
    mouse.down()
    phase(visit, "carrying")
    mouse.wheel(0, -250)
    visit.page.wait_for_timeout(200)
    off = offset(visit, at)
    for k in range(1, 7):
        y = START[1] + (GOAL[1] - START[1]) * k / 6
        mouse.move(*seen(visit, (START[0] + way * math.sin(math.pi * k / 6), y, OVER), off))
        visit.page.wait_for_timeout(120)
    mouse.wheel(0, 250)
    visit.page.wait_for_timeout(400)
    mouse.up()


def offset(visit: Visit, at: tuple[float, ...]) -> list[float]:
    """How far the box is from what is under the pointer, at the height where it is carried."""
    plane = f"{{through: [0, 0, {OVER}], normal: [0, 0, 1]}}"
    hit = visit.page.evaluate(f"teachpath.unproject({at[0]}, {at[1]}, {plane})")
    return [START[0] - hit[0], START[1] - hit[1], 0.0]


def seen(visit: Visit, point: tuple[float, float, float], off: list[float]) -> tuple[float, ...]:
    under = [p - o for p, o in zip(point, off, strict=True)]
    return tuple(visit.page.evaluate(f"teachpath.project({under})"))


def finish(visit: Visit) -> str:
    """End the sitting; return what the page says of it."""
    visit.page.get_by_role("button", name="Finish").click()
    visit.page.wait_for_selector("html[data-showing='']", state="attached")
    visit.page.wait_for_selector("#message p")
    said: str = visit.page.locator("#message").inner_text()
    return said


def has_no_gaps(take: dict[str, Any]) -> bool:
    return take["account"]["lost"] == take["account"]["gaps"] == take["account"]["refused"] == 0


def test_takes_by_mouse_are_judged_at_once_discarded_and_brought_back(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-mouse")
    for _ in range(2):
        carry(visit)
        phase(visit, "ready")
    takes = service.demonstrations("by-mouse")
    words = [take["verdict"] for take in takes]
    assert visit.page.locator("#show .takes li .verdict").all_inner_texts() == words
    for take in takes:  # a machine that is too busy for the declared rate makes it a repaired one
        assert take["verdict"] in ("clean", "repaired"), take["reasons"]
        assert has_no_gaps(take)
    goal = service.call("GET", f"/demonstrations/{takes[0]['id']}/trajectory")["positions"][-1]
    assert math.dist(goal, GOAL) < 0.05
    visit.page.get_by_role("button", name="Discard the take").click()
    visit.page.wait_for_selector("#show .takes li.discarded")
    assert [bool(take["discarded_ns"]) for take in service.demonstrations("by-mouse")] == [False, True]
    visit.page.get_by_role("button", name="Undo", exact=True).click()
    visit.page.wait_for_selector("#show .takes li.discarded", state="detached")
    assert "Recorded 2 demonstrations" in finish(visit)
    assert service.call("GET", "/tasks/by-mouse/recording") == []
    assert visit.said == []


def test_a_take_by_keyboard(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-keys")
    keys = visit.page.keyboard
    keys.press("Enter")
    phase(visit, "carrying")
    for key in ("PageUp", "ArrowLeft", "PageDown"):
        keys.down(key)
        visit.page.wait_for_timeout(500)
        keys.up(key)
    keys.press("Enter")
    phase(visit, "ready")
    finish(visit)
    was_carried(service, "by-keys")


def was_carried(service: Service, task: str) -> None:
    (take,) = service.demonstrations(task)
    assert take["verdict"] != "reject", take["reasons"]
    assert has_no_gaps(take)
    ways = service.call("GET", f"/demonstrations/{take['id']}/trajectory")["positions"]
    assert max(z for _, _, z in ways) > START[2] + 0.05
    assert math.dist(ways[-1][:2], START[:2]) > 0.05


def test_a_take_by_gamepad(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-pad")
    visit.page.evaluate("pad.connected = true; pad.buttons[0].pressed = true; 0")
    phase(visit, "carrying")
    for axes in ("0, 0, 0, -1", "-1, 0.1, 0, 0"):  # the right stick up, then the left one to the left
        visit.page.evaluate(f"pad.axes = [{axes}]; 0")
        visit.page.wait_for_timeout(500)
    visit.page.evaluate("pad.axes = [0, 0, 0, 0]; pad.buttons[0].pressed = false; 0")
    phase(visit, "ready")
    visit.page.evaluate("pad.connected = false; 0")
    finish(visit)
    was_carried(service, "by-pad")


def test_a_take_by_touch_with_a_second_finger_for_the_height(visit: Visit, service: Service) -> None:
    begin(visit, service, "by-touch")
    fingers = visit.page.context.new_cdp_session(visit.page)

    def touch(kind: str, *points: tuple[float, float]) -> None:
        at = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": at})

    x, y = visit.page.evaluate(f"teachpath.project({list(START)})")
    touch("touchStart", (x, y))
    phase(visit, "carrying")
    second = (x + 120, y)
    touch("touchStart", (x, y), second)
    for k in range(1, 5):
        touch("touchMove", (x, y), (second[0], second[1] - 30 * k))
        visit.page.wait_for_timeout(60)
    for k in range(1, 6):
        touch(
            "touchMove", (x + 12 * k, y - 4 * k)
        )  # without the second finger, which is lifted; the first still carries
        visit.page.wait_for_timeout(60)
    visit.page.wait_for_timeout(200)
    touch("touchEnd")
    phase(visit, "ready")
    finish(visit)
    was_carried(service, "by-touch")


def test_a_hidden_page_stops_and_throws_away_what_was_carried(visit: Visit, service: Service) -> None:
    begin(visit, service, "hidden")
    visit.page.keyboard.press("Enter")
    phase(visit, "carrying")
    visit.page.wait_for_timeout(600)
    hide = "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
    visit.page.evaluate(hide + "document.dispatchEvent(new Event('visibilitychange'))")
    visit.page.wait_for_selector("#message p.error")
    assert "The page was hidden" in visit.page.locator("#message").inner_text()
    assert service.call("GET", "/tasks/hidden/recording") == []
    assert service.demonstrations("hidden") == []
    visit.page.evaluate("delete document.hidden")


# a headset, emulated

HEADSET = """
const device = globalThis.headset = new IWER.XRDevice(IWER.metaQuest3);
device.installRuntime({forceInstall: true});
device.primaryInputMode = 'hand';
"""
# The emulated head stands in the middle of its room and looks along -z: the page puts it to the table, facing the arm.
STAND = 1.25  # [m] of the page's stand before the arm


@pytest.fixture
def worn(browser: Any, service: Service) -> Iterator[Visit]:
    script = (ASSETS / "iwer" / "iwer.min.js").read_text() + HEADSET
    visit = Visit(browser, service.url, script=script)
    visit.page.set_viewport_size({"width": 900, "height": 240})  # the frames of a headset are drawn in software here
    yield visit
    visit.page.close()


def in_room(point: tuple[float, float, float]) -> dict[str, float]:
    """Where in the headset's room a place in the robot's world is."""
    x, y, z = point
    return {"x": y, "y": z, "z": x - STAND}


def move_hand(visit: Visit, point: tuple[float, float, float], pinch: float) -> None:
    room = in_room(point)
    place = f"{room['x']}, {room['y']}, {room['z']}"
    visit.page.evaluate(f"headset.hands.right.position.set({place}); headset.hands.right.updatePinchValue({pinch}); 0")


def move_controller(visit: Visit, point: tuple[float, float, float], trigger: float) -> None:
    room = in_room(point)
    place = f"{room['x']}, {room['y']}, {room['z']}"
    right = "headset.controllers.right"
    visit.page.evaluate(f"{right}.position.set({place}); {right}.updateButtonValue('trigger', {trigger}); 0")


def carry_worn(visit: Visit, move: Any) -> None:
    """Close the hand at the box, carry it over the obstacles, open it and rest."""
    move(visit, START, 0)
    visit.page.wait_for_timeout(400)
    move(visit, START, 1)
    phase(visit, "carrying")
    over = [
        (START[0], START[1] + (GOAL[1] - START[1]) * k / 20, START[2] + 0.24 * math.sin(math.pi * k / 20))
        for k in range(21)
    ]
    for point in over:
        move(visit, point, 1)
        visit.page.wait_for_timeout(60)
    move(visit, GOAL, 0)


# Keeps of every sample: its time, whether a take is under way, and how many pictures were drawn before.
HEAR = """
(() => {
  const hand = teachpath.headset();
  const { hear } = hand;
  globalThis.heard = [];
  hand.hear = (sample) => {
    heard.push([sample.ms, document.documentElement.dataset.showing === "carrying", hand.rig.drawn]);
    hear(sample);
  };
})()
"""
LIMIT = 0.25  # [s] longest gap of a take, by the service's settings


def gaps_of(heard: np.ndarray) -> np.ndarray:
    """Seconds from each sample to the next; no picture of the page's own may have torn one in a take."""
    gaps = np.diff(heard[:, 0]) / 1000
    torn = (gaps > LIMIT) & (heard[:-1, 1] > 0) & (np.diff(heard[:, 2]) > 0)
    assert not torn.any(), gaps[torn]
    return gaps


def is_judged_by_its_frames(take: dict[str, Any], gaps: np.ndarray) -> None:
    """A machine without a graphics card may give no frames for a while: the verdict says that, and nothing else."""
    gap = take["account"]["longest_gap_ns"] / 1e9
    assert np.abs(gaps - gap).min() < 1e-5  # as the page stamped it
    assert (take["verdict"] == "reject") == (gap > LIMIT), take["reasons"]
    assert len(take["reasons"]) == (gap > LIMIT), take["reasons"]


PICTURES = """async ([cost, frames]) => {
  const { Pictures } = await import("/web/hand/pictures.js");
  const pictures = new Pictures();
  let [time, drawn] = [0, false];
  return frames.map((busy) => {
    time += drawn ? cost : 11;
    drawn = pictures.affords(time, busy);
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
    begin(worn, service, "by-headset", button="In a headset")
    worn.page.evaluate(HEAR)
    carry_worn(worn, move_hand)
    phase(worn, "ready")
    worn.page.evaluate("headset.primaryInputMode = 'controller'; 0")
    carry_worn(worn, move_controller)
    phase(worn, "ready")
    frames, samples = worn.page.evaluate("[teachpath.headset().frames, teachpath.headset().samples]")
    assert frames == samples > 100
    gaps = gaps_of(np.array(worn.page.evaluate("heard"), dtype=float))
    worn.page.evaluate("teachpath.headset().end()")
    worn.page.get_by_role("button", name="Finish").click()
    worn.page.wait_for_selector("html[data-showing='']", state="attached")
    by_hand, by_controller = service.demonstrations("by-headset")
    for take in (by_hand, by_controller):
        is_judged_by_its_frames(take, gaps)
        assert has_no_gaps(take)
        ways = service.call("GET", f"/demonstrations/{take['id']}/trajectory")
        assert len(ways["orientations"]) == len(ways["positions"])
        assert math.dist(ways["positions"][0], START) < 1e-6
        assert math.dist(ways["positions"][-1], GOAL) < 0.05
    assert worn.said == []


def test_without_a_headset_the_page_says_why(visit: Visit) -> None:
    assert visit.page.get_by_role("button", name="In a headset").is_disabled()
    assert "No headset is connected" in visit.page.locator("#show").inner_text()
