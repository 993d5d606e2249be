import os
import shutil
from collections.abc import Iterator
from typing import Any

import pytest

from tests.system.processes import Service


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
