"""The whole story in the page, from showing to the first motion, by mouse or finger; every act is counted."""

import itertools
from abc import ABC, abstractmethod
from typing import Any

from tests.system.carriers import ARRIVED_SCRIPT, START, carry, phase, until_box
from tests.system.operators import RESTING_STATES, Operator
from tests.system.visits import Visit

LOOK_COUNT = 60  # for the click of a tap, before it is tapped again
HEAR_SCRIPT = "one => { one.heard = false; one.addEventListener('click', () => (one.heard = true), {once: true}); }"


class Hand(ABC):
    """Somebody who works at the page with a hand, and counts what it does."""

    def __init__(self, visit: Visit, actions: int = 0) -> None:
        self.visit, self.page, self.actions = visit, visit.page, actions

    def show(self) -> None:
        """Carry the object once."""
        self.actions += 1
        self._carry()
        phase(self.visit, "ready")

    def press(self, selector: str) -> None:
        """Press what is there, once it can be pressed."""
        self.actions += 1
        button = self.page.locator(f"{selector} >> visible=true")
        button.click(trial=True)  # nothing covers it, and it stays where it is
        self._press(button)

    def drag(self, point: str, dx: float, dy: float) -> None:
        """Drag a point, an expression of the page, over the picture by so many pixels."""
        self.actions += 1
        self.page.locator("#view").scroll_into_view_if_needed()
        x, y = self.visit.project(point)
        self._down(x, y)
        for share in (0.5, 1.0):
            self._move(x + share * dx, y + share * dy)
        self._up()

    def start(self) -> None:
        """Keep the start pressed until the arm moves; where a busy machine made it miss, again."""
        self.actions += 1
        button = self.page.locator("#arm button.hold:enabled")
        sent: list[Any] = []

        def hear(request: Any) -> None:
            if request.method == "POST" and request.url.endswith("/executions"):
                sent.append(request)

        def is_missed() -> bool:
            return not sent and self.page.locator("#arm button.holding").count() == 0

        def begun() -> bool:
            button.click(trial=True)
            box = button.bounding_box()
            sent.clear()
            self._down(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            looks = itertools.count()
            self.visit.wait(lambda: bool(sent) or (is_missed() and next(looks) > LOOK_COUNT))
            self._up()
            return bool(sent) and bool(sent[0].response().ok)

        self.page.on("request", hear)
        self.visit.wait(begun, "the arm moves")
        self.page.remove_listener("request", hear)

    @abstractmethod
    def _press(self, button: Any) -> None: ...

    @abstractmethod
    def _carry(self) -> None: ...

    @abstractmethod
    def _down(self, x: float, y: float) -> None: ...

    @abstractmethod
    def _move(self, x: float, y: float) -> None: ...

    @abstractmethod
    def _up(self) -> None: ...


class Mouse(Hand):
    """A hand at the mouse."""

    def _press(self, button: Any) -> None:
        button.click()

    def _carry(self) -> None:
        carry(self.visit)

    def _down(self, x: float, y: float) -> None:
        self.page.mouse.move(x, y)
        self.page.mouse.down()

    def _move(self, x: float, y: float) -> None:
        self.page.mouse.move(x, y)

    def _up(self) -> None:
        self.page.mouse.up()


class Fingers(Hand):
    """A hand at a screen that feels fingers."""

    def __init__(self, visit: Visit, actions: int = 0) -> None:
        super().__init__(visit, actions)
        self._browser = self.page.context.new_cdp_session(self.page)

    def _touch(self, kind: str, *points: tuple[float, float]) -> None:
        at = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self._browser.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": at})

    def _press(self, button: Any) -> None:
        button.evaluate(HEAR_SCRIPT)
        here = button.element_handle()

        def tapped() -> bool:
            box = here.bounding_box()
            self._down(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            self._up()
            looks = itertools.count()
            self.visit.wait(lambda: here.evaluate("one => one.heard") or next(looks) > LOOK_COUNT)
            return bool(here.evaluate("one => one.heard"))  # else it came so slowly that it was a long press

        self.visit.wait(tapped, "the tap is a click")

    def _carry(self) -> None:
        """Press on the box, lift it with a second finger, and carry it on with the first alone."""
        self.page.locator("#view").scroll_into_view_if_needed()
        x, y = self.visit.project(str(list(START)))
        self._touch("touchStart", (x, y))
        phase(self.visit, "carrying")
        second = (x + 120, y)
        self._touch("touchStart", (x, y), second)
        for k in range(1, 5):
            self._touch("touchMove", (x, y), (second[0], second[1] - 30 * k))
        until_box(self.visit, f"at[2] > {START[2] + 0.1} && {ARRIVED_SCRIPT}")
        for k in range(1, 6):
            self._touch("touchMove", (x + 12 * k, y - 4 * k))  # the second finger is lifted
        until_box(self.visit, f"Math.hypot(at[0] - {START[0]}, at[1] - {START[1]}) > 0.06 && {ARRIVED_SCRIPT}")
        self._touch("touchEnd")

    def _down(self, x: float, y: float) -> None:
        self._touch("touchStart", (x, y))

    def _move(self, x: float, y: float) -> None:
        self._touch("touchMove", (x, y))

    def _up(self) -> None:
        self._touch("touchEnd")


def tell(hand: Hand, operator: Operator) -> int:
    """Finish, learn, edit a way, certify it, run it and stop the arm; return the acts up to the first motion."""
    visit, page = hand.visit, hand.page
    hand.press("#demonstration-session button:has-text('Finish')")
    hand.press("#demonstration-session [data-learn]:enabled")
    hand.press("[data-edit] >> nth=0")
    visit.wait(lambda: page.evaluate("teachpath.editor.draft !== null && teachpath.framed()"))
    hand.drag("editor.draft.curve.control_points[2]", 0, -14)
    hand.press("#edit-save:enabled")
    hand.press("#edit-certify:enabled:has-text('Certify version 2')")
    hand.press("#edit-run")
    visit.wait(lambda: page.evaluate("teachpath.state().plan?.path_version === 2"))
    hand.start()
    acts = hand.actions
    hand.press("#stop")
    visit.wait(lambda: operator.executions()[0].status.state in RESTING_STATES)
    return acts
