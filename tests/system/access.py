"""What keeps people from a page: the findings of axe-core."""

from pathlib import Path
from typing import Any

AXE = (Path(__file__).parent / "assets" / "axe" / "axe.min.js").read_text()


def grave(page: Any, where: str) -> list[tuple[str, str, str]]:
    """Return (where, rule, first element) of every serious or critical finding on the page as it looks now."""
    page.evaluate("Promise.all(document.getAnimations().map((one) => one.finished.catch(() => {})))")  # what fades
    page.evaluate(f"{AXE};0")
    result = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    assert len(result["passes"]) > 10  # it has looked
    found = [v for v in result["violations"] if v["impact"] in ("serious", "critical")]
    return [(where, v["id"], v["nodes"][0]["html"]) for v in found]
