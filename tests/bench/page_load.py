"""What the page loads over the line until its scene is drawn, in a headless Chromium: bytes, requests and time."""

import shutil
import tempfile
from collections import Counter
from typing import Any

from teachpath.commands.serving import free_port, serving
from teachpath.config import load
from teachpath_client import Station
from tests.bench.motion import show
from tests.bench.page import BROWSERS, FLAGS
from tests.bench.report import Figure, against, print_report

MAX_KB = 600.0  # [kB] asked for
FIRST_PAINT_LIMIT, SCENE_LIMIT = 0.3, 1.5  # [s] asked for, from the request on
SCENE_SCRIPT = """
  new MutationObserver((_, observer) => {
    if (document.documentElement?.dataset.scene !== "ready") return;
    performance.mark("scene ready");
    observer.disconnect();
  }).observe(document, { subtree: true, attributes: true, attributeFilter: ["data-scene"] });
"""
INSTANT_SCRIPT = "(name) => performance.getEntriesByName(name)[0].startTime / 1000"
KINDS = {"/web/": "modules and style sheets", "/vendor/": "the viewer", "/api/": "REST"}


def measure() -> list[Figure]:
    """Return the figures of a station with twelve demonstrations; none, and a sentence, where there is no browser."""
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
            station.learn("demo")
            return _figures(*_loaded(browser, url))


def _loaded(browser: str, url: str) -> tuple[Counter[str], Counter[str], list[float]]:
    """Open the page; return bytes and requests, by kind, and when it painted first and its scene stood [s]."""
    from playwright.sync_api import sync_playwright

    kinds: dict[str, str] = {}
    sizes: Counter[str] = Counter()
    requests: Counter[str] = Counter()

    def on_request(event: dict[str, Any]) -> None:
        address = event["request"]["url"].removeprefix(url)
        kind = next((kind for start, kind in KINDS.items() if address.startswith(start)), "the document and others")
        kinds[event["requestId"]] = kind
        requests[kind] += 1

    def on_end(event: dict[str, Any]) -> None:
        sizes[kinds.get(event["requestId"], "the document and others")] += int(event["encodedDataLength"])

    def on_frame(event: dict[str, Any]) -> None:
        text, is_text = event["response"]["payloadData"], event["response"]["opcode"] == 1
        sizes["WebSockets, before their compression"] += len(text) if is_text else len(text) * 3 // 4

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=browser, headless=True, args=FLAGS)
        page = running.new_page(viewport={"width": 1280, "height": 800})
        line = page.context.new_cdp_session(page)
        line.send("Network.enable")
        line.on("Network.requestWillBeSent", on_request)
        line.on("Network.loadingFinished", on_end)
        line.on("Network.webSocketFrameReceived", on_frame)
        page.add_init_script(SCENE_SCRIPT)
        page.goto(url)
        page.wait_for_selector("html[data-scene=ready]", state="attached", timeout=120_000)
        page.wait_for_load_state("networkidle")
        times = [page.evaluate(INSTANT_SCRIPT, name) for name in ("first-contentful-paint", "scene ready")]
        running.close()
    return sizes, requests, times


def _figures(sizes: Counter[str], requests: Counter[str], times: list[float]) -> list[Figure]:
    total = sum(sizes.values()) / 1000
    first_paint, scene_ready = times
    return [
        against("its first paint", [first_paint], "s", name="asked for", value=FIRST_PAINT_LIMIT),
        against("its scene is drawn", [scene_ready], "s", name="asked for", value=SCENE_LIMIT),
        against("the page, until its scene is drawn", [total], "kB", name="asked for", value=MAX_KB),
        *(Figure(f"  {kind}", (size / 1000,), "kB") for kind, size in sizes.most_common()),
        Figure("requests", (float(sum(requests.values())),), "requests"),
    ]


if __name__ == "__main__":
    print_report("What the page loads", measure())
