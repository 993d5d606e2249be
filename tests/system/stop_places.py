"""Where the page's Stop is at six widths: it must be in one place, large enough, and above everything else."""

from typing import Any

WIDTHS = (360, 390, 600, 860, 1024, 1920)
PLACE = (16.0, 8.0, 140.0)  # [px] from the right and from above, and its width
LEAST_HEIGHT = 44.0  # [px]
TOP_ELEMENT = "([x, y]) => document.elementFromPoint(x, y)?.id"


def stop_faults(page: Any, state: str) -> list[str]:
    """Return what is wrong with Stop in a state of the page, at each width; the page's size is what it was."""
    size = page.viewport_size
    faults = [fault for width in WIDTHS if (fault := _fault(page, width, state))]
    page.set_viewport_size(size)
    return faults


def _fault(page: Any, width: int, state: str) -> str:
    page.set_viewport_size({"width": width, "height": 420})
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")  # a long panel on a phone
    stop = page.locator("#stop")
    box = stop.bounding_box()
    if box is None or not stop.is_enabled():
        return f"{state}, {width} px: Stop is hidden or off"
    place = (width - box["x"] - box["width"], box["y"], box["width"])
    if place != PLACE or box["height"] < LEAST_HEIGHT:
        return f"{state}, {width} px: Stop is at {place}, {box['height']} px high"
    at = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
    above = page.evaluate(TOP_ELEMENT, at)
    return "" if above == "stop" else f"{state}, {width} px: {above!r} is above Stop"
