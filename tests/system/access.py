"""What keeps people from a page: the findings of axe-core, and controls that are off and do not say why."""

from pathlib import Path
from typing import Any

AXE = (Path(__file__).parent / "assets" / "axe" / "axe.min.js").read_text()
UNNAMED_SCRIPT = """[...document.querySelectorAll(":disabled")].filter((one) => one.checkVisibility() && !one.title)
  .map((one) => one.outerHTML)"""

Finding = tuple[str, str, str]  # where, rule, first element


def barriers(page: Any, where: str) -> list[Finding]:
    """Return every finding of any level on the page as it looks now, and every control that is off without a reason."""
    page.evaluate("Promise.all(document.getAnimations().map((one) => one.finished.catch(() => {})))")  # what fades
    page.evaluate(f"{AXE};0")
    result = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    assert len(result["passes"]) > 10  # it has looked
    silent = [(where, "off without a reason", html) for html in page.evaluate(UNNAMED_SCRIPT)]
    return [(where, v["id"], v["nodes"][0]["html"]) for v in result["violations"]] + silent
