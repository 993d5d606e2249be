"""The page's tab Edit as an operator uses it, and the arm that does what was edited."""

import json
from typing import Any

import numpy as np
from websockets.sync.client import connect

from teachpath.motion.kinematics import tool_pose
from teachpath.nurbs import Curve
from tests.system.processes import Service, wait_until
from tests.system.test_view import Visit

U = np.linspace(0, 1, 301)
SLOW = 60_000  # [ms] a busy machine draws a frame in seconds


class Desk(Visit):
    """A page on whose tab Edit one path is open."""

    def __init__(self, browser: Any, service: Service, path: str) -> None:
        super().__init__(browser, service.url)
        self.page.set_viewport_size({"width": 1000, "height": 620})  # fewer pixels to draw without a graphics card
        self.open(path)

    def open(self, path: str) -> None:
        self.page.click("#tab-edit")
        self.page.wait_for_selector(f"[data-path='{path}']", state="attached", timeout=SLOW)
        self.page.click(f"[data-path='{path}']")
        self.until(f"editor.draft?.path === '{path}'")

    def until(self, condition: str) -> None:
        self.page.wait_for_function(
            f"() => {{ const editor = teachpath.editor; return {condition}; }}", timeout=SLOW, polling=50
        )

    def ask(self, expression: str) -> Any:
        return self.page.evaluate(f"() => {{ const editor = teachpath.editor; return {expression}; }}")

    def curve(self) -> Curve:
        c = self.ask("editor.draft.curve")
        return Curve(c["degree"], c["knots"], c["control_points"], c["weights"])

    def drag(self, index: int, dx: float, dy: float, *, steps: int = 6) -> None:
        """Drag a control point over the picture by so many pixels."""
        x, y = self.ask(f"teachpath.project(editor.draft.curve.control_points[{index}])")
        mouse = self.page.mouse
        mouse.move(x, y)
        mouse.down()
        mouse.move(x + dx, y + dy, steps=steps)
        mouse.up()

    def click(self, selector: str) -> None:
        self.page.locator(selector).click(timeout=SLOW)

    def save(self, **words: str) -> None:
        for name, text in words.items():
            self.page.fill(f"#edit-{name}", text)
        self.click("#edit-save")


def same_shape(a: Curve, b: Curve, *, within: float = 1e-9) -> bool:
    return float(np.abs(a(U) - b(U)).max()) <= within


def executed(service: Service, plan: str) -> np.ndarray:
    """Run a plan and return where the tool was while it followed the path."""
    places: list[np.ndarray] = []
    with connect(service.url.replace("http", "ws") + "/api/v1/joints") as socket:
        execution = service.call("POST", "/executions", {"plan": plan, "override": 0.3})["id"]

        def ended() -> bool:
            frame = json.loads(socket.recv(timeout=10))
            status = frame["status"] or {}
            if status.get("execution") != execution:
                return False
            assert status["state"] != "faulted", status["reason"]
            if status["state"] == "held":  # on a starved machine
                service.call("POST", f"/executions/{execution}/resume")
            if status["state"] == "following" and 0.05 < status["progress"] < 0.9:
                places.append(tool_pose(np.array(frame["position"])[None])[0, :3, 3])
            return bool(status["state"] == "ended")

        wait_until(ended, seconds=120, what="the execution ends")
    return np.array(places)
