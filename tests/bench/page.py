"""The editor in the page, in a headless Chromium: what a dragged frame costs, how soon the service has looked."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

from teachpath.commands.serving import free_port, serving
from teachpath.config import load
from teachpath_client import Station
from tests.bench.motion import show
from tests.bench.report import Figure, against

POINTS = 20  # control points of the path that is dragged
FRAME = 16.0  # [ms] limit of a frame
ANSWER = 150.0  # [ms] limit from release to verdict
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]


def measure(*, drags: int) -> list[Figure]:
    """Return the figures of so many drags; none, and a sentence, where there is no browser."""
    browser = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if browser is None:
        print("the page is not measured: there is no Chromium\n")
        return []
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        endpoint = f"tcp/127.0.0.1:{free_port()}"
        places = {"web": {"port": free_port()}, "bus": {"endpoint": endpoint}, "store": {"data_dir": folder}}
        settings = load(document=places)
        url = f"http://127.0.0.1:{settings.web.port}"
        with serving(settings), Station(url) as station:
            show(endpoint)
            path = _fine_path(station)
            with _page(browser, url) as page:
                _open(page, path)
                return _figures(_drag(page, drags)) + _adaptation_figures(_drag_object(page, drags))


def _fine_path(station: Station) -> str:
    """Learn, and give a path as many control points as are to be dragged, its shape unchanged."""
    path = station.learn("demo").learned.paths[0]
    curve = asdict(path.curve)
    for k in range(POINTS - len(path.curve.control_points)):
        curve = station.call("POST", "/curves/insert-knot", {"curve": curve, "u": (k + 1) / (POINTS + 1)})["curve"]
    station.save_version(path.id, curve, base=1, branch="main")
    return path.id


@contextmanager
def _page(browser: str, url: str) -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=browser, headless=True, args=FLAGS)
        page = running.new_page(viewport={"width": 1000, "height": 620})
        page.goto(url)
        page.wait_for_selector("html[data-scene=ready]", state="attached")
        yield page
        running.close()


def _open(page: Any, path: str) -> None:
    page.locator("#tab-edit").click()
    page.locator(f"#edit-path [data-path='{path}']").click()
    _until(page, f"editor.draft?.path === '{path}' && editor.draft.curve.control_points.length === {POINTS}")
    _until(page, "editor.feasibility?.assessment")


def _drag(page: Any, drags: int) -> dict[str, Any]:
    """Drag one control point after another and wait for every verdict; return what the page measured."""
    for k in range(drags + 1):
        index = 2 + k % (POINTS - 4)
        x, y = page.evaluate(f"teachpath.project(teachpath.editor.draft.curve.control_points[{index}])")
        page.mouse.move(x, y)
        page.mouse.down()
        side = 1 if k % 2 else -1
        for step in range(1, 13):
            page.mouse.move(x + side * step, y - step / 2)
            page.wait_for_timeout(16)
        page.mouse.up()
        _until(page, "editor.feasibility.curve === editor.draft.curve && !editor.feasibility.pending")
        page.locator("#edit-undo").click()
        _until(page, "editor.feasibility.curve === editor.draft.curve && !editor.feasibility.pending")
        if k == 0:  # the first one compiles
            page.evaluate("teachpath.editor.timings.reset()")
    figures: dict[str, Any] = page.evaluate("teachpath.editor.timings.summary")
    return figures


def _drag_object(page: Any, drags: int) -> dict[str, Any]:
    """Drag the object to and fro; return what the page measured."""
    page.locator("#edit-adapt").click()
    page.wait_for_selector("#edit-adapt[aria-pressed=true]")
    page.evaluate("teachpath.editor.timings.reset()")
    for k in range(drags):
        metres = "['x', 'y', 'z'].map((axis) => document.getElementById(`edit-start-${axis}`).value / 1000)"
        x, y = page.evaluate(f"teachpath.project({metres})")
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(1, 13):
            page.mouse.move(x + (step if k % 2 else -step), y)
            page.wait_for_timeout(16)
        page.mouse.up()
    figures: dict[str, Any] = page.evaluate("teachpath.editor.timings.summary")
    return figures


def _adaptation_figures(seen: dict[str, Any]) -> list[Figure]:
    what = "a frame while the object is dragged, the page's own work"
    return [
        against(f"{what}, {share}", [seen["work"][share]], "ms", name="a frame", value=FRAME)
        for share in ("p50", "p95")
    ]


def _figures(seen: dict[str, Any]) -> list[Figure]:
    frame = f"a dragged frame of {POINTS} control points, the page's own work"
    answer = "from release to verdict"
    shares = [
        (what, seen[key], share) for what, key in ((frame, "work"), (answer, "answer")) for share in ("p50", "p95")
    ]
    limits = {frame: ("a frame", FRAME), answer: ("asked for", ANSWER)}
    figures = [
        against(f"{what}, {share}", [values[share]], "ms", name=limits[what][0], value=limits[what][1])
        for what, values, share in shares
    ]
    drawn = "handing the scene to a graphics card, which is software here"
    figures += [Figure(f"{drawn}, {share}", (seen["renderTime"][share],), "ms") for share in ("p50", "p95")]
    figures.append(Figure("dragged frames measured", (float(seen["frames"]),), "frames"))
    return figures


def _until(page: Any, condition: str) -> None:
    page.wait_for_function(
        f"() => {{ const editor = teachpath.editor; return {condition}; }}", timeout=60_000, polling=20
    )
