"""The page's tab Edit as an operator uses it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from teachpath.nurbs import Curve
from tests.system.gizmos import pull_handle
from tests.system.visits import Visit

U = np.linspace(0, 1, 301)


class Desk(Visit):
    """A page for the tab Edit; what its console said is judged when it closes."""

    def __init__(self, browser: Any, url: str, path: str = "") -> None:
        super().__init__(browser, url, size=(1000, 620))
        if path:
            self.open(path)

    def close(self) -> None:
        self.page.close()
        assert [line for line in self.said if "409" not in line] == []  # a browser itself notes a refused request

    def open(self, path: str) -> None:
        self.click("#tab-edit")
        self.click(f"#edit-path [data-path='{path}']")
        self.until(f"editor.draft?.path === '{path}'")

    def until(self, condition: str) -> None:
        self.page.wait_for_function(f"() => {{ const editor = teachpath.editor; return {condition}; }}", polling=50)

    def ask(self, expression: str) -> Any:
        return self.page.evaluate(f"() => {{ const editor = teachpath.editor; return {expression}; }}")

    def curve(self) -> Curve:
        c = self.ask("editor.draft.curve")
        return Curve(c["degree"], c["knots"], c["control_points"], c["weights"])

    def drag(self, index: int, dx: float, dy: float, *, steps: int = 6) -> None:
        """Drag a control point over the picture by so many pixels."""
        x, y = self.project(f"editor.draft.curve.control_points[{index}]")
        mouse = self.page.mouse
        mouse.move(x, y)
        mouse.down()
        mouse.move(x + dx, y + dy, steps=steps)
        mouse.up()

    def pull(self, handle: str, along: tuple[float, float, float]) -> None:
        """Drag a handle of the gizmo, X to Z or two of them for a plane, which lies that way from its middle."""
        pull_handle(self, "teachpath.editor.gizmo", handle, along)

    def toggle(self, index: int) -> None:
        """Click a control point with Shift."""
        with self.shift():
            self.page.mouse.click(*self.project(f"editor.draft.curve.control_points[{index}]"))

    @contextmanager
    def shift(self) -> Iterator[None]:
        """Hold Shift."""
        self.page.keyboard.down("Shift")
        yield
        self.page.keyboard.up("Shift")

    def unfold(self, section: str) -> None:
        """Unfold the section with this id, unless it is."""
        if not self.page.locator(section).is_visible():
            self.click(f"summary:has(+ {section})")

    def save(self) -> None:
        self.click("#edit-save")

    def click(self, selector: str) -> None:
        self.page.locator(selector).click()
