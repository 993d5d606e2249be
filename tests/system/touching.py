"""A tracker that is held still where it is told to, and what an operator calibrates and places with it in the page."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from numpy.typing import NDArray
from websockets.sync.client import connect

from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from tests.system.changes import tab
from tests.system.processes import Service
from tests.system.visits import Visit

Array = NDArray[np.float64]

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # to the world from the tracker's frame
OFFSET = np.array([0.3, -0.2, 0.4])  # [m]
PAUSE = 0.005  # [s] between samples, which are 20 ms apart by the tracker's own clock


class HeldTracker:
    """A tracker over a WebSocket that is held still at a place of the world, another one whenever it is told."""

    def __init__(self, service: Service, name: str) -> None:
        self._address = f"{service.url.replace('http', 'ws')}/api/v1/trackers/{name}/samples"
        self._ended = threading.Event()
        self.place: Array = OFFSET

    @contextmanager
    def sending(self) -> Iterator[None]:
        """Send samples in the block."""
        thread = threading.Thread(target=self._send)
        thread.start()
        try:
            yield
        finally:
            self._ended.set()
            thread.join()

    def _send(self) -> None:
        with connect(self._address) as socket:
            number = 0
            while not self._ended.wait(PAUSE):
                number += 1
                position = dict(zip("xyz", (TURN.T @ (self.place - OFFSET)).tolist(), strict=True))
                sample = {"sequence": number, "device_ns": 20_000_000 * number, "position": position, "tracked": True}
                socket.send(json.dumps({"sample": sample}))


def calibrate_by_touch(visit: Visit, service: Service) -> None:
    """Calibrate a tracker to the corners of the table, place a box with it, and ask where the arm's tool is."""
    page, message = visit.page, visit.page.locator("#message")
    tracker = HeldTracker(service, "pointer")
    with tracker.sending():
        tab(visit, "scene")
        page.locator("summary:has(+ #calibration)").click()
        page.wait_for_selector("#calibration-device option[value=pointer]", state="attached")
        page.select_option("#calibration-device", "pointer")
        for number in (1, 2, 3, 4):
            tracker.place = proposed(visit)
            page.locator("#calibration-touch:enabled").click()
            page.locator(f"#calibration-points li:nth-child({number})").wait_for()
        page.locator("#calibration-points li:nth-child(4):has-text('0.0 mm off')").wait_for()
        page.locator("#calibration-name").fill("pointed")
        assert page.locator("#calibration-keep").is_disabled()  # before it was tried
        page.locator("#calibration-try:enabled").click()
        page.locator("#calibration-verdict:has-text('0.0 mm from the nearest corner')").wait_for()
        page.locator("#calibration-keep:enabled").click()
        message.get_by_text("The calibration pointed is kept as version 1.").wait_for()
        kept = service.station.call("GET", "/calibrations/pointed")[0]
        assert kept["calibration"]["offset"] == pytest.approx(OFFSET, abs=1e-6)
        assert kept["source"] == "pointer"
        place_a_box(visit, tracker)
    page.select_option("#calibration-aim", "table")
    page.locator("#calibration-touch:enabled").click()
    seen = page.locator("#calibration-points li:has-text('seen at')").inner_text().partition("seen at ")[2]
    tool = tool_pose(np.array(MotionSettings().home), Arm.of_variant())[:3, 3]  # where the arm waits
    assert [float(value) for value in seen.removesuffix(" mm").split(", ")] == pytest.approx(1000 * tool, abs=1.0)
    page.locator("#scene-revert:enabled").click()


def proposed(visit: Visit) -> Array:
    """Return the place that the page proposes to touch [m]."""
    fields = [visit.page.locator(f"#calibration-{axis}").input_value() for axis in "xyz"]
    return np.array([float(value) for value in fields]) / 1000


def place_a_box(visit: Visit, tracker: HeldTracker) -> None:
    """Add a box of 0.1 m, and put it where three points of its top are touched, turned by a quarter turn."""
    page = visit.page
    page.select_option("#shape-kind", label="a box")
    page.locator("#shape-add").click()
    page.select_option("#calibration-aim", "shape")
    page.select_option("#calibration-device", "pointer")
    page.wait_for_selector("#calibration-frame option[value=pointed]", state="attached")
    page.select_option("#calibration-frame", "pointed")
    corner = np.array([0.5, 0.2, 0.6])
    for number, away in enumerate(([0, 0, 0], [0, 0.1, 0], [-0.1, 0, 0]), 1):
        page.locator(f"#calibration-next:has-text('Point {number} of 3')").wait_for()
        tracker.place = corner + away
        page.locator("#calibration-touch:enabled").click()
        if number < 3:
            page.locator(f"#calibration-points li:nth-child({number})").wait_for()
    page.locator("#scene-undo[title^='Undo placing box']").wait_for()
    found = [page.locator(f"#shape-position-{axis}").input_value() for axis in "xyz"]
    assert [float(value) for value in found] == pytest.approx([450.0, 250.0, 550.0], abs=0.01)
    assert float(page.locator("#shape-turn-z").input_value()) == pytest.approx(90.0, abs=0.01)
