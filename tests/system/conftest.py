import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.system.demos import Start
from tests.system.processes import Command, Service, free_ports


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One running service for the tests of a module; each uses tasks and trackers of its own."""
    with Service(tmp_path_factory.mktemp("station") / "data") as service:
        yield service


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    names = ("chromium", "chromium-browser", "google-chrome")
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        sentence = "no Chromium to look at the page with; get it with: sudo apt-get install chromium"
        if os.environ.get("TEACHPATH_REQUIRE_BROWSER"):
            pytest.fail(sentence)
        pytest.skip(sentence)
    from playwright.sync_api import sync_playwright

    # Without a graphics card; these flags keep the console free of messages about that.
    flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, headless=True, args=flags)
        yield browser
        browser.close()


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    started: list[Command] = []

    def demo(*arguments: str, port: int | None = None) -> Command:
        web, bus = free_ports(2)
        environment = {"TEACHPATH_BUS__ENDPOINT": f"tcp/127.0.0.1:{bus}"}
        words = ("demo", "--port", str(port or web), *arguments)
        started.append(Command(*words, folder=tmp_path, environment=environment))
        return started[-1]

    yield demo
    for command in started:
        command.clean_up()
