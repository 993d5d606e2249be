"""How the tests carry the box in the page: by mouse, and by an emulated headset's hand or controller."""

import math
from typing import Any

import numpy as np

from teachpath_client.models import Demonstration
from tests.system.processes import Service
from tests.system.visits import Visit

START, GOAL = (0.58, -0.28, 0.52), (0.58, 0.28, 0.52)  # of the box in the paper's scene
CARRY_HEIGHT = 0.62  # [m] height at which it is carried between the obstacles


def phase(visit: Visit, name: str) -> None:
    visit.page.wait_for_selector(f"html[data-session={name}]", state="attached")


def until_box(visit: Visit, condition: str) -> None:
    """Wait until the box, `at` [m], which follows the hand's `target` no faster than a hand, is where it should be."""
    box = "const { position: at, target } = teachpath.session().handModel"
    visit.page.wait_for_function(f"() => {{ {box}; return {condition}; }}", polling=20)


ARRIVED_SCRIPT = "Math.hypot(...at.map((value, i) => value - target[i])) < 0.005"


def choose_new(visit: Visit, service: Service, task: str) -> None:
    """Choose a new task of the paper's scene, to be shown without countdown."""
    service.station.make_task(task)
    visit.page.wait_for_selector(f"#task option[value={task}]", state="attached")
    visit.page.select_option("#task", task)
    visit.page.locator("#tab-demonstrate").click()
    visit.page.get_by_label("Countdown").select_option("0")


def begin(visit: Visit, service: Service, task: str, button: str = "Show it here") -> None:
    """Choose a new task and begin to show it."""
    choose_new(visit, service, task)
    visit.page.get_by_role("button", name=button).click()
    phase(visit, "ready")


def carry(visit: Visit, *, way: float = 0.0) -> None:
    """Press on the box, lift it with the wheel, carry it between the obstacles, lower it and let go."""
    mouse = visit.page.mouse
    at = visit.project(str(list(START)))
    mouse.move(*at)
    mouse.down()
    phase(visit, "carrying")
    mouse.wheel(0, -250)
    until_box(
        visit, f"at[2] > {CARRY_HEIGHT - 0.005}"
    )  # the corners of the path are where they are, however slow the page is
    off = offset(visit, at)
    for k in range(1, 7):
        y = START[1] + (GOAL[1] - START[1]) * k / 6
        mouse.move(*seen(visit, (START[0] + way * math.sin(math.pi * k / 6), y, CARRY_HEIGHT), off))
        until_box(visit, f"Math.abs(at[1] - {y}) < 0.015")
    until_box(visit, f"Math.abs(at[1] - {GOAL[1]}) < 0.01")
    mouse.wheel(0, 250)
    until_box(visit, f"at[2] < {GOAL[2] + 0.01} && {ARRIVED_SCRIPT}")
    mouse.up()


def offset(visit: Visit, at: tuple[float, float]) -> list[float]:
    """How far the box is from what is under the pointer, at the height where it is carried."""
    plane = f"{{through: [0, 0, {CARRY_HEIGHT}], normal: [0, 0, 1]}}"
    hit = visit.page.evaluate(f"teachpath.unproject({at[0]}, {at[1]}, {plane})")
    return [START[0] - hit[0], START[1] - hit[1], 0.0]


def seen(visit: Visit, point: tuple[float, float, float], off: list[float]) -> tuple[float, float]:
    under = [p - o for p, o in zip(point, off, strict=True)]
    return visit.project(str(under))


def finish(visit: Visit) -> str:
    """End the sitting; return what the page says of it."""
    visit.page.get_by_role("button", name="Finish").click()
    visit.page.wait_for_selector("html[data-session='']", state="attached")
    visit.page.wait_for_selector("#message p")
    said: str = visit.page.locator("#message").inner_text()
    return said


def has_no_gaps(take: Demonstration) -> bool:
    return take.statistics.lost == take.statistics.gaps == take.statistics.refused == 0


# a headset, emulated

HEADSET = """
const device = globalThis.headset = new IWER.XRDevice(IWER.metaQuest3);
device.installRuntime({forceInstall: true});
device.primaryInputMode = 'hand';
"""
# The emulated head stands in the middle of its room and looks along -z: the page puts it to the table, facing the arm.
STAND = 1.25  # [m] of the page's stand before the arm


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


def carry_worn(visit: Visit, move: Any, *, rise: float = 0.24) -> None:
    """Close the hand at the box, carry it over the obstacles, `rise` [m] higher half way, open it and rest."""
    move(visit, START, 0)
    visit.page.wait_for_timeout(400)  # at least: a hand that was elsewhere leaps to the box
    visit.page.evaluate(NEXT_SCRIPT)
    move(visit, START, 1)
    phase(visit, "carrying")
    over = [
        (START[0], START[1] + (GOAL[1] - START[1]) * k / 100, START[2] + rise * math.sin(math.pi * k / 100))
        for k in range(101)
    ]
    device = "hands" if move is move_hand else "controllers"
    visit.page.evaluate(FOLLOW % device, [list(in_room(point).values()) for point in over])
    move(visit, GOAL, 0)


# Resolves when the headset's hand has been sampled again: where drawing is slow the carrying is slow, and no leap.
NEXT_SCRIPT = """async () => {
  const hand = teachpath.headset();
  for (const before = hand.samples; hand.samples === before; ) await new Promise((done) => setTimeout(done, 5));
}"""


# Moves a hand or controller on after every sample, as a hand moves on: one that stood for several would be frozen.
FOLLOW = """async (places) => {
  const hand = teachpath.headset();
  const { onSample } = hand;
  await new Promise((done) => {
    hand.onSample = (sample) => {
      onSample(sample);
      if (places.length > 0) headset.%s.right.position.set(...places.shift());
      else done();
    };
  });
  hand.onSample = onSample;
}"""

# Keeps the time of every sample [ms] of the headset that is put on next, from its first one.
HEAR_SCRIPT = """async () => {
  const { XrHand } = await import("/web/hand/xr_hand.js");
  globalThis.heard = [];
  Object.defineProperty(XrHand.prototype, "onSample", {
    get() { return this.listener; },
    set(listener) {
      this.listener = (sample) => {
        if (heard.at(-1) !== sample.ms) heard.push(sample.ms);
        listener(sample);
      };
    },
  });
}"""


def is_judged_by_its_frames(take: Demonstration, heard: np.ndarray) -> None:
    """A machine without a graphics card may give no frames for a while: that is a gap as the page has stamped it.

    The emulated device now and then shows one pose in two frames, which the recorder says and leaves out; what comes
    late is put into its place after the gap was counted. So up to three frames of the page may lie within a gap.
    """
    gap = take.statistics.longest_gap_ns / 1e9
    stamped = np.concatenate([heard[k:] - heard[:-k] for k in range(1, 5)]) / 1000
    assert np.abs(stamped - gap).min() < 1e-5, (take.statistics, np.diff(heard).tolist())
    assert take.verdict != "reject", take.reasons
    assert all("repeat" in reason for reason in take.reasons), take.reasons
