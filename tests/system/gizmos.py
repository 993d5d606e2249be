"""The arrows and planes in the page's view by which a point or a body is dragged."""

import numpy as np

from tests.system.visits import Visit


def pull_handle(visit: Visit, gizmo: str, handle: str, along: tuple[float, float, float]) -> None:
    """Drag a handle of a gizmo, X to Z or two of them for a plane, which lies that way from its middle.

    Args:
        visit: a page with the gizmo in view.
        gizmo: expression of the page.
        handle: its name.
        along: the way, in the robot's axes.
    """
    mouse = visit.page.mouse
    start, way, far = np.zeros(2), np.zeros(2), 0

    def found() -> bool:
        nonlocal start, way, far
        start, ahead = (
            np.array(visit.project(f"{gizmo}.anchor.position.toArray().map((value, i) => value + {ends}[i])"))
            for ends in ([0, 0, 0], list(along))
        )
        way = (ahead - start) / max(float(np.linalg.norm(ahead - start)), 1e-9)
        for far in range(4, 90, 2):  # [px]
            mouse.move(*(start + far * way))
            if visit.page.evaluate(f"{gizmo}.controls.axis") == handle:
                return True
        return False

    visit.wait(found, f"the pointer is on the handle {handle}")  # which lies where it was drawn last
    mouse.down()
    mouse.move(*(start + (far + 30) * way), steps=4)
    mouse.up()
