"""The documents as a site: whole, with nothing of another machine, and shown by the service under a strict policy."""

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import FastAPI

from teachpath.access.access import Access
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.settings import AuthSettings
from teachpath.api.help import help_router
from teachpath.commands.serving import listen
from tests.ports import free_ports
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

ROOT = Path(__file__).parents[2]
PICTURE = re.compile(r'<img\b[^>]*src="([^":]+)"')
ODD_NAMES = ["%00.html", "%FF.html", "%ED%A0%80.html", "x" * 5000 + ".html"]  # names that no file has
FETCHED_PATTERN = re.compile(r"""<(?:script|img|link)\b[^>]*(?:src|href)="((?:https?:)?//[^"]*)""")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The documents, built as `make docs` does; a link that leads nowhere ends it."""
    folder = tmp_path_factory.mktemp("site") / "help"
    command = [sys.executable, "-m", "mkdocs", "build", "-q", "-d", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with served(site) as address:
        yield address


@contextmanager
def served(folder: Path) -> Iterator[str]:
    app, (port,) = FastAPI(), free_ports(1)
    app.state.access = Access(AuthSettings(), MemoryTokens(), MemoryPeople())
    app.include_router(help_router(folder))
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", ws="none"))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listen("127.0.0.1", port)]}, daemon=True)
    thread.start()
    wait_until(lambda: server.started, "the server has started")
    yield f"http://127.0.0.1:{port}/help"
    server.should_exit = True
    thread.join(HANG)


def test_nothing_is_fetched_from_another_machine(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 25
    assert {page.name: found for page in pages if (found := FETCHED_PATTERN.findall(page.read_text()))} == {}
    assert [style.name for style in site.rglob("*.css") if re.search(r"url\(['\"]?https?:", style.read_text())] == []


def test_the_reference_has_every_command_setting_error_and_name(site: Path) -> None:
    def words(name: str) -> str:
        return (site / "reference" / f"{name}.html").read_text()

    for command in ("teachpath curve export", "teachpath doctor", "teachpath-client driver-check"):
        assert command in words("commands")
    assert "clearance_min" in words("settings")
    assert "NotStopped" in words("errors")
    assert "/plans/{plan}/program" in words("rest")
    assert 'id="teachpath_client.station.Station' in words("python")


def test_a_browser_shows_and_searches_them_under_the_policy(browser: Any, address: str) -> None:
    page, said = browser.new_page(), []
    page.set_default_timeout(1000 * HANG)
    page.on("console", lambda message: said.append(message.text))
    page.goto(address)
    page.wait_for_selector("h1:has-text('teachpath')")
    page.get_by_role("link", name="What a certificate proves").first.click()
    page.wait_for_selector("h1:has-text('What a certificate proves')")
    page.wait_for_load_state("load")  # its script hears keys from then on
    page.keyboard.press("/")
    page.keyboard.type("tool_speed")
    page.wait_for_selector(".md-search-result__item, [class*=search] a[href*='certificate']", state="attached")
    assert said == []
    page.close()


def test_every_picture_is_given_out(site: Path, address: str) -> None:
    pictures = {name for page in site.rglob("*.html") for name in PICTURE.findall(page.read_text())}
    assert {Path(name).suffix for name in pictures} >= {".png", ".webp"}
    for name in pictures:
        (file,) = site.rglob(Path(name).name)
        answer = httpx.get(f"{address}/{file.relative_to(site)}", timeout=HANG, trust_env=False)
        assert (answer.status_code, answer.headers["content-type"].split("/")[0]) == (200, "image"), name


@pytest.mark.parametrize("name", ["%2e%2e/app.py", "..%2fapp.py", "none.html", "sitemap.xml.gz", "assets", *ODD_NAMES])
def test_only_documents_are_given_out(address: str, name: str) -> None:
    answer = httpx.get(f"{address}/{name}", timeout=HANG, trust_env=False)
    assert (answer.status_code, "there is no document" in answer.text) == (404, True)


def test_where_nobody_built_them_it_is_said_how(tmp_path: Path) -> None:
    with served(tmp_path / "none") as address:
        answer = httpx.get(f"{address}/index.html", timeout=HANG, trust_env=False)
    assert (answer.status_code, "make docs" in answer.text) == (404, True)
