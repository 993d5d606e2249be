"""Makes the pictures of README and documents anew: `python -m tests.system.pictures` (some minutes, with Chromium)."""

import io
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tests.conftest import NAMES, NO_CHROMIUM, chromium
from tests.system.processes import Service
from tests.system.test_station import record
from tests.system.visits import Visit

DOCS = Path(__file__).parents[2] / "docs"
SIZE = (1200, 750)  # of the page
SMALL_SIZE = (800, 500)  # of the moving picture
INSTANTS = 30  # of the motion that it shows
READING_TIME = 1800  # [ms] for a picture that stands
FRAME = 120  # [ms] for one that moves


def main() -> None:
    """Teach a station the paper's first experiment, and picture the page's tabs and the motion."""
    program = next((path for name in NAMES if (path := shutil.which(name))), None)
    if program is None:
        sys.exit(NO_CHROMIUM)
    with (
        tempfile.TemporaryDirectory() as folder,
        Service(Path(folder) / "data") as service,
        chromium(program) as browser,
    ):
        record(service, "demo", 12)
        learned = service.station.learn("demo").learned
        service.station.plan(learned.paths[0].id)
        visit = Visit(browser, service.url, size=SIZE)
        visit.wait(lambda: visit.page.evaluate("teachpath.settled() && teachpath.state().runs?.length === 1"))
        stills = [pictured(visit, tab) for tab in ("demonstrate", "ways", "edit")]
        stills[1].quantize(256).save(DOCS / "view.png", optimize=True)
        motion = moved(visit)
        motion[INSTANTS // 2].quantize(256).save(DOCS / "run.png", optimize=True)
        save_moving([*stills, *motion], [READING_TIME] * len(stills) + [FRAME] * INSTANTS)
        visit.page.emulate_media(color_scheme="dark")
        visit.page.locator("#view").focus()
        pictured(visit, "edit").quantize(256).save(DOCS / "edit.png", optimize=True)


def pictured(visit: Visit, tab: str) -> Image.Image:
    """The page with a tab that was chosen, once the view stands."""
    visit.page.click(f"#tab-{tab}")
    visit.page.mouse.move(0, 0)
    if tab == "edit":
        visit.page.locator("#edit-feasibility .good").wait_for()
    visit.draws_when_at_rest()
    return Image.open(io.BytesIO(visit.page.screenshot())).convert("RGB")


def moved(visit: Visit) -> list[Image.Image]:
    """The ghost arm at instants of the certified motion, which the slider sets: a slow machine shows them too."""
    pictured(visit, "run")
    visit.page.get_by_role("button", name="Preview").click()
    slider = visit.page.locator("#preview .player input")
    slider.wait_for()

    def at(seconds: float) -> Any:
        slider.evaluate("(s, t) => { s.value = t; s.dispatchEvent(new Event('input')); }", float(seconds))
        visit.draws_when_at_rest()
        return Image.open(io.BytesIO(visit.page.screenshot())).convert("RGB")

    return [at(seconds) for seconds in np.linspace(0.0, float(slider.get_attribute("max") or 0.0), INSTANTS)]


def save_moving(frames: list[Image.Image], durations: list[int]) -> None:
    """Write an animated WebP, which browsers show without an end."""
    first, *others = [frame.resize(SMALL_SIZE, Image.Resampling.LANCZOS) for frame in frames]
    file = DOCS / "teachpath.webp"
    first.save(file, save_all=True, append_images=others, duration=durations, loop=0, quality=60, method=6)


if __name__ == "__main__":
    main()
