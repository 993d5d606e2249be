"""A driver of an arm tells its state: the page shows it, and motion that nobody asked for waits for somebody's word."""

import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from teachpath_client import Link
from teachpath_client.driver import SetpointPlayer, joint_state
from teachpath_client.errors import ClientError
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role
from tests.system.processes import Service, run
from tests.system.visits import Visit
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

KEYS = Keys()
HOME = [0.365, 1.663, -3.177, 0.0, -1.628, 0.365]  # [rad]


class Driver:
    """An arm that stands where it is told to by this test, and says of itself what the test tells it."""

    def __init__(self, link: Link) -> None:
        self.position, self.says = list(HOME), dict[str, Any](gripper_opening=0.07)
        self._publisher = link.publisher(KEYS.state("puma560"))
        self._gone, self._thread = threading.Event(), threading.Thread(target=self._speak)

    def __enter__(self) -> "Driver":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._gone.set()
        self._thread.join(HANG)

    def _speak(self) -> None:
        player = SetpointPlayer(HOME)
        while not self._gone.wait(0.02):
            self._publisher.put(joint_state(player, self.position, [0.0] * 6, **self.says))


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    with Service(tmp_path / "data", TEACHPATH_SIMULATOR__START="false") as service:
        yield service


def test_the_page_shows_what_the_driver_says_and_motion_nobody_asked_for_is_acknowledged(
    service: Service, browser: Any, tmp_path: Path
) -> None:
    station = service.station
    with Link(service.endpoint, role=Role.ROBOT) as link, Driver(link) as driver:
        station.wait_for_arm(timeout=HANG)
        visit = Visit(browser, service.url)
        page = visit.page
        page.locator("#tab-run").click()
        arm = page.locator("#arm")
        arm.get_by_text("open, 70").wait_for()
        driver.says = {"gripper_opening": 0.031, "protective_stop": True}
        arm.get_by_text("Protective stop: the arm's own controller").wait_for()
        arm.get_by_text("open, 31").wait_for()
        driver.says = {"fault": "brake 3 is worn", "enabled": False}
        arm.get_by_text("reports a fault: brake 3 is worn").wait_for()
        driver.says = {}
        arm.get_by_text("open, not measured").wait_for()

        wait_until(lambda: push(driver) or unasked_motion(service), "the motion is noticed")
        with pytest.raises(ClientError, match="although no execution is under way"):
            station.begin_teleoperation("glove", scene="empty")
        arm.get_by_role("button", name="acknowledge").wait_for()
        wait_until(lambda: any("rests again" in entry.answer for entry in station.journal()), "the arm rests")
        (executor,) = service.find("[executor]")
        os.kill(executor, signal.SIGKILL)
        wait_until(lambda: service.find("[executor]") not in ([], [executor]), "another executor is started")
        station.wait_for_arm(timeout=HANG)
        with pytest.raises(ClientError, match="although no execution is under way"):
            station.begin_teleoperation("glove", scene="empty")
        wait_until(lambda: unasked_motion(service), "neither rest nor another executor is enough")
        arm.get_by_role("button", name="acknowledge").click()
        wait_until(lambda: not unasked_motion(service), "it is acknowledged")
        arm.get_by_role("button", name="acknowledge").wait_for(state="hidden")
        command = run("acknowledge", "--url", service.url, folder=tmp_path)  # nothing is to be acknowledged any more
        assert (command.process.returncode, command.out) == (0, "acknowledged: executions may start\n")
        page.close()


def push(driver: Driver) -> None:
    """Push the arm a little farther."""
    driver.position = [driver.position[0] + 0.001, *driver.position[1:]]


def unasked_motion(service: Service) -> str:
    """Return what the executor says of motion that nobody asked for."""
    status = service.station.health().executor
    return status.unasked_motion if status else ""
