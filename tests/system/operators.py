"""The page's tab Run as an operator uses it, on a machine that may be too busy for the arm."""

import itertools
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from teachpath.motion.arm.puma560 import TOOL_LENGTH
from teachpath_client import HandReading, Link, Station, Tracker
from teachpath_client.models import Execution
from teachpath_proto.control import ExecutorState
from teachpath_proto.keys import Keys
from tests.system.carriers import NEXT_SCRIPT, START, move_hand
from tests.system.visits import Visit
from tests.waiting import wait_until

RESTING_STATES = frozenset(state for state in ExecutorState if state.is_resting)
# Why the executor holds the arm by itself when the arm's own process gets no turn: an operator then says it again.
STARVED_REASONS = ("no joint state", "the arm has taken up no setpoint", "setpoints were late")
RELEASE_CLUTCH_REASON = (
    "let the clutch go"  # what the executor asks for when the clutch is held though the arm does not follow
)
SETTLED_SAMPLES = 50  # control periods after the answer to an order in which the executor tells what came of it

Status = dict[str, Any]
Done = Callable[[], bool]


class Operator:
    """Somebody at the tab Run of a page.

    Args:
        station: whose page it is; None where it answers on another machine, for the page alone.
    """

    def __init__(self, visit: Visit, station: Station | None = None) -> None:
        self.page, self._station, self._visit = visit.page, station, visit

    @property
    def said(self) -> list[str]:
        """What the console said, but for orders while the arm was silent (503) or not at rest again yet (409)."""
        return [line for line in self._visit.said if "503" not in line and "409" not in line]

    def executions(self) -> list[Execution]:
        """All executions, newest first."""
        assert self._station
        return self._station.executions()

    def status(self) -> Status:
        """How the newest execution stands, as the page knows it."""
        found: Status = self.page.evaluate("teachpath.state().executor ?? {state: 'silent', reason: '', length: 0}")
        return found

    def press(self, name: str) -> None:
        """Click an order as soon as the page offers it, and again while the arm is silent or not at rest."""

        def taken() -> bool:
            with self.page.expect_response(is_order) as answer:
                self.page.get_by_role("button", name=name, exact=True).click()
            return bool(answer.value.ok)

        self._visit.wait(taken)

    def try_to(self, name: str) -> None:
        """Click an order; nothing happens where the page does not offer it now."""
        self.page.get_by_role("button", name=name, exact=True).click(force=True)

    def answer_to(self, resource: str) -> Any:
        """Expect the answer to a POST."""
        return self.page.expect_response(
            lambda answer: answer.request.method == "POST" and answer.url.endswith(f"/{resource}")
        )

    def start(self) -> None:
        """Hold the start until the arm begins."""
        before = [one.id for one in self.executions()]

        def begun() -> bool:
            self.page.locator("#arm button.hold:not([disabled])").click(
                trial=True
            )  # it is there, and nothing covers it
            button = self.page.locator("#arm button.hold")
            with self.answer_to("executions") as answer:  # told to it itself: what comes above it meanwhile moves it
                button.dispatch_event("pointerdown")
            button.dispatch_event("pointerup")
            return bool(answer.value.ok)

        self._visit.wait(begun)
        self._visit.wait(lambda: self.status().get("execution", "") not in ("", *before))

    def until(self, true: Callable[[Status], bool], *, again: str = "Resume") -> Status:
        """Wait until the status is such; press `again` whenever the arm was held because its process got no turn."""
        seen: list[Status] = []

        def done() -> bool:
            seen.append(self.status())
            if true(seen[-1]):
                return True
            if seen[-1]["state"] == "held" and seen[-1]["reason"].startswith(STARVED_REASONS):
                self.try_to(again)
            return False

        try:
            self._visit.wait(done)
        except AssertionError:
            raise AssertionError(f"it never was so; {seen[-1]}") from None
        return seen[-1]

    def step(self, name: str, way: float) -> float:
        """Go a step and return where it ends; where setpoints were late, so that the arm rests short of it, try again.

        Between two tries it goes the other way, so that it comes to no end of the path.
        """
        before = self.executions()[0].status.length
        while abs((length := self.rest_after(name)) - before - way) >= 1e-5:
            before = self.rest_after({"+ 1 cm": "− 1 cm", "− 1 cm": "+ 1 cm"}[name])
        return length

    def rest_after(self, name: str) -> float:
        """Order a step and return where the arm comes to rest [m along the path]."""
        self.press(name)
        ordered = self.executions()[0].status.cycles
        seen: list[tuple[float, int]] = []  # where the arm was held, and in which control period

        def rests() -> bool:
            now = self.executions()[0].status
            if now.state == "held" and now.cycles > ordered + SETTLED_SAMPLES:
                seen.append((now.length, now.cycles))
            return any(length == now.length and cycles < now.cycles - SETTLED_SAMPLES for length, cycles in seen)

        wait_until(rests, "the arm rests after a step")
        length = seen[-1][0]
        self.until(lambda status: abs(status["length"] - length) < 1e-5)  # the page says it, too
        return length


def is_order(answer: Any) -> bool:
    """Whether it answers an order to an execution; what the page reads of executions is none."""
    return answer.request.method == "POST" and "/executions/" in answer.url


def grasp_point(flange: np.ndarray) -> np.ndarray:
    """Where the gripper grasps [m], of the flange's pose (4, 4)."""
    point: np.ndarray = flange[:3, 3] + TOOL_LENGTH * flange[:3, 2]
    return point


def named_joints(route: Any) -> None:
    """Answer as a service does whose arm's model has names of its own for its joints."""
    answer = route.fetch()
    arm = answer.json()
    for k, joint in enumerate(arm["joints"]):
        joint["name"] = f"axis {k}"
    route.fulfill(response=answer, json=arm)


class Leader(Operator):
    """Somebody who leads the arm by a live hand; where a busy machine makes it lose the hand, it is led again."""

    def begin(self, hand: str = "this page") -> None:
        """Let the arm follow a hand, once its clutch is held."""
        self.page.locator(f"#teleop-hand option[value='{hand}']").wait_for(state="attached")
        self.page.select_option("#teleop-hand", hand)

        def begun() -> bool:
            with self.answer_to("teleoperation") as answer:
                self.page.get_by_role("button", name="Lead the arm").click()
            return bool(answer.value.ok)

        self._visit.wait(lambda: self.status()["state"] != "silent")
        self._visit.wait(begun)
        self.wait_ready()

    def wait_ready(self) -> None:
        """Wait until the arm waits for the clutch alone; why it was let go is still said then."""
        self.until(
            lambda status: (
                status["state"] == "held" and not status["reason"].startswith((*STARVED_REASONS, RELEASE_CLUTCH_REASON))
            )
        )

    def tool(self) -> np.ndarray:
        """Where the grasp point is drawn [m]."""
        return grasp_point(self._visit.place("/robot/link6"))

    def tool_at_rest(self) -> np.ndarray:
        """Where the grasp point is drawn, once the arm rests."""
        return grasp_point(self._visit.place_at_rest("/robot/link6"))

    @property
    def _pressed(self) -> bool:
        return bool(self.page.evaluate("teachpath.teleop()?.clutchPressed"))

    @property
    def _is_led(self) -> bool:
        """Whether the clutch is pressed and has not to be let go; an arm that was late goes on by itself."""
        return self._pressed and not self.status()["reason"].startswith((*STARVED_REASONS, RELEASE_CLUTCH_REASON))

    def lead(self, press: Callable[[], None], move: Callable[[], None], let_go: Callable[[], None], done: Done) -> None:
        """Hold the clutch, move, and wait for what is expected; then let go, and wait until the arm is held."""

        def led() -> bool:
            self.wait_ready()
            press()
            looks = itertools.count()
            self._visit.wait(lambda: self._pressed or next(looks) > 40)  # a press beside the ball is none
            self._visit.wait(lambda: self.status()["state"] == "following" or not self._is_led)
            move()
            self._visit.wait(lambda: done() or not self._is_led)
            reached = done()
            let_go()
            return reached

        wait_until(led, "the arm is led there")
        self.wait_ready()

    def lead_upwards(self) -> None:
        """Lead the arm 5 cm up by a headset's right hand while its left one is closed, and end the session."""
        self.begin("a headset")
        self._visit.wait(lambda: self.page.evaluate("teachpath.teleop().isPositioned"))
        begin = np.zeros(3)

        def clutch(closed: int) -> None:
            self.page.evaluate(f"headset.hands.left.updatePinchValue({closed}); 0")

        def press() -> None:
            move_hand(self._visit, START, 0)
            self.page.evaluate(NEXT_SCRIPT)
            begin[:] = self.tool()
            clutch(1)

        def led() -> bool:
            return bool(np.linalg.norm(self.tool() - begin - [0, 0, 0.05]) < 0.002)

        above = (START[0], START[1], START[2] + 0.05)
        self.lead(press, lambda: move_hand(self._visit, above, 0), lambda: clutch(0), led)
        self.page.locator("#teleop").get_by_role("button", name="Finish").evaluate("button => button.click()")
        self.until(lambda status: status["state"] == "ended")


class Shown:
    """A tracker's hand that is where it was put, 50 times a second, on a thread of its own; it has no button."""

    def __init__(self, link: Link, name: str) -> None:
        self.place = (0.0, 0.0, 0.0)  # [m]
        self._tracker = Tracker(link, name)
        self._publisher = link.publisher(Keys().samples(name))
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._show, daemon=True)

    def __enter__(self) -> "Shown":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _show(self) -> None:
        number = 0
        while not self._over.wait(0.02):
            number += 1
            reading = HandReading(number * 0.02, self.place)
            self._publisher.put(reading.message(number, time.time_ns()).SerializeToString())
