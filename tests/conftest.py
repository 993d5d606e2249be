"""The browser of all tests that look at the page, a last line that says when they were left out, and no deadlines.

The database server of all tests that need one, too.
"""

import importlib.util
import os
import shutil
import signal
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadScopeScheduling

from teachpath.commands.serving import PRELOADED
from teachpath.process_server import CONTEXT
from tests.object_storage import ObjectServer, serving_objects
from tests.postgres import NO_POSTGRESQL, Server, find_programs, serving

# No example fails because the machine was busy, and every run has the same ones: what fails once, fails again.
settings.register_profile("teachpath", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("teachpath")

# A shell ignores Ctrl-C for what it runs in the background, and all that is started from there inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The processes of jobs fork from one that has loaded what they need, as a service's do; the first of them starts it.
CONTEXT.set_forkserver_preload(list(PRELOADED))

NAMES = ("chromium", "chromium-browser", "google-chrome")
NO_CHROMIUM = "no Chromium to look at the page with; get it with: sudo apt-get install chromium"
# The logins of the stations that tests start lie here, not among this user's own.
STATE = tempfile.TemporaryDirectory(prefix="teachpath-tests-")
os.environ["XDG_STATE_HOME"] = STATE.name
# Root's Chromium raises its priority over that of the station, which no other user's can; and what draws here is no
# graphics card but the processor that the arm needs.
CHROMIUM = """#!/bin/sh
[ "$(id -u)" = 0 ] && exec nice -n 5 setpriv --bounding-set=-sys_nice --inh-caps=-sys_nice {0} "$@"
exec nice -n 5 {0} "$@"
"""
REQUIRED_VARIABLE = "TEACHPATH_REQUIRE_BROWSER"  # set where the browser tests must run: without a browser they fail


def find_chromium() -> str:
    """Where Chromium is; without one the test is left out, or fails where browser tests are asked for."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        if os.environ.get(REQUIRED_VARIABLE):
            pytest.fail(f"{NO_CHROMIUM} (or unset {REQUIRED_VARIABLE})")
        pytest.skip(NO_CHROMIUM)
    return found


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium, headless."""
    with chromium(find_chromium()) as browser:
        yield browser


@contextmanager
def chromium(command: str, *more: str, **environment: str) -> Iterator[Any]:
    """A headless browser, started by a command, with more flags and variables than it needs."""
    from playwright.sync_api import sync_playwright

    program = Path(STATE.name) / "chromium"
    program.write_text(CHROMIUM.format(command))
    program.chmod(0o700)
    # Without a graphics card; these flags keep the console free of messages about that.
    flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", *more]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=str(program), headless=True, args=flags, env=os.environ | environment
        )
        yield browser
        browser.close()


@pytest.fixture
def objects(monkeypatch: pytest.MonkeyPatch) -> Iterator[ObjectServer]:
    """A server of object storage, which clients find by their environment."""
    with serving_objects() as server:
        for name, value in server.environment.items():
            monkeypatch.setenv(name, value)
        yield server


@pytest.fixture(scope="session")
def postgres() -> Iterator[Server]:
    """A PostgreSQL server of the tests' own."""
    if find_programs() is None or importlib.util.find_spec("psycopg") is None:
        pytest.skip(NO_POSTGRESQL)
    with serving() as server:
        yield server


def system_modules(*names: str) -> set[str]:
    return {f"tests/system/test_{name}.py" for name in names}


# System tests that draw pages, and move an arm at most where no time is judged.
DRAWING_MODULES = system_modules(
    "behind_nginx", "camera", "editing", "import_page", "late_answers", "other_machine", "page", "review_package",
    "showing", "sign_in", "view",
)  # fmt: skip
# System tests that do neither: each module may run beside any other.
UNDEMANDING_MODULES = system_modules(
    "broken_storage", "crashes", "cut_router", "devices", "disk", "evaluate", "hands_free", "help", "hostile", "kill",
    "lines", "other_user", "recording", "several_machines", "station", "tracker_check", "wheel",
)  # fmt: skip
LONGEST_GROUPS = ("moving", "drawing")


def scope(nodeid: str) -> str:
    """What one worker runs in one go: all system tests that move the arm, all that draw pages, or another module."""
    module = nodeid.partition("::")[0]
    if not module.startswith("tests/system/") or module in UNDEMANDING_MODULES:
        return module
    return "drawing" if module in DRAWING_MODULES else "moving"


class SystemBesideTheRest(LoadScopeScheduling):
    """One worker moves arms, one test after the other, and one draws pages, while others run modules of the rest."""

    def _split_scope(self, nodeid: str) -> str:
        return scope(nodeid)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest."""
    order = {name: number for number, name in enumerate(LONGEST_GROUPS)}
    items.sort(key=lambda item: order.get(scope(item.nodeid), len(order)))


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> SystemBesideTheRest:
    return SystemBesideTheRest(config, log)


@pytest.hookimpl(wrapper=True, tryfirst=True)  # around the terminal's own, so that nothing comes behind
def pytest_sessionfinish(session: pytest.Session) -> Generator[None, object, object]:
    result = yield
    terminal = session.config.pluginmanager.get_plugin("terminalreporter")
    skipped = terminal.stats.get("skipped", []) if terminal else []
    left_out = [report for report in skipped if NO_CHROMIUM in str(report.longrepr)]
    if left_out:
        terminal.write_line(f"browser tests left out: {len(left_out)}, {NO_CHROMIUM}", yellow=True)
    return result
