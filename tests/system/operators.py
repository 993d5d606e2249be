"""The page's tab Run as an operator uses it, on a machine that may be too busy for the arm."""

from collections.abc import Callable
from typing import Any

from tests.system.test_view import Visit, wait_until

RESTING = ("idle", "ended", "faulted")
# Why the executor holds the arm by itself when the arm's own process gets no turn: an operator then says it again.
STARVED = ("no joint state", "the arm has taken up no setpoint")

Status = dict[str, Any]


class Operator:
    """Somebody at the tab Run of a page; `station` has `call` as the service's API."""

    def __init__(self, visit: Visit, station: Any) -> None:
        self.page, self._station, self._visit = visit.page, station, visit

    @property
    def said(self) -> list[str]:
        """What the console said, but for orders while the arm was silent (503) or not at rest again yet (409)."""
        return [line for line in self._visit.said if "503" not in line and "409" not in line]

    def executions(self) -> list[dict[str, Any]]:
        """All executions, newest first."""
        found: list[dict[str, Any]] = self._station.call("GET", "/executions")
        return found

    def status(self) -> Status:
        """How the newest execution stands, as the page knows it."""
        found: Status = self.page.evaluate("teachpath.state().executor ?? {state: 'silent', reason: '', length: 0}")
        return found

    def press(self, name: str) -> None:
        """Click an order as soon as the page offers it, and again while the arm is silent or not at rest."""

        def taken() -> bool:
            with self.page.expect_response(lambda answer: "/executions/" in answer.url) as answer:
                self.page.get_by_role("button", name=name, exact=True).click()
            return bool(answer.value.ok)

        self._visit.wait(taken)

    def try_to(self, name: str) -> None:
        """Click an order; nothing happens where the page does not offer it now."""
        self.page.get_by_role("button", name=name, exact=True).click(force=True)

    def hold_start(self, milliseconds: int) -> None:
        """Press the button that starts the arm for so long."""
        button = self.page.get_by_role("button", name="Hold to start the arm")
        button.scroll_into_view_if_needed()
        box = button.bounding_box()
        assert box is not None
        self.page.mouse.move(box["x"] + 20, box["y"] + box["height"] / 2)
        self.page.mouse.down()
        self.page.wait_for_timeout(milliseconds)
        self.page.mouse.up()

    def start(self) -> None:
        """Hold the start until the arm begins."""
        before = [one["id"] for one in self.executions()]
        self.page.wait_for_selector("button.hold:not([disabled])")
        self.hold_start(1000)
        self._visit.wait(lambda: self.status().get("execution", "") not in ("", *before))

    def until(self, true: Callable[[Status], bool], *, seconds: float = 60.0, again: str = "Resume") -> Status:
        """Wait until the status is such; press `again` whenever the arm was held because its process got no turn."""
        seen: list[Status] = []

        def done() -> bool:
            seen.append(self.status())
            if true(seen[-1]):
                return True
            if seen[-1]["state"] == "held" and seen[-1]["reason"].startswith(STARVED):
                self.try_to(again)
            return False

        try:
            wait_until(done, seconds, lambda pause: self.page.wait_for_timeout(1000 * pause))
        except AssertionError:
            raise AssertionError(f"not within {seconds:g} s; {seen[-1]}") from None
        return seen[-1]
