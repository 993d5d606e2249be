"""The client on a small computer: only what the base install brings may be imported."""

import subprocess
import sys
from functools import cache
from importlib.metadata import packages_distributions

import pytest
from packaging.utils import canonicalize_name

from tests.distributions import required
from tests.waiting import HANG

GUARD = """
import sys
allowed = set({allowed!r}) | set(sys.stdlib_module_names)
class Guard:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] not in allowed:
            raise ModuleNotFoundError(f"{{name}} is not in the base install", name=name)
sys.meta_path.insert(0, Guard())
"""
IMPORT_PROGRAM = """
import pkgutil, importlib, teachpath_client
for module in pkgutil.walk_packages(teachpath_client.__path__, "teachpath_client."):
    importlib.import_module(module.name)
"""
SYNTHETIC_PROGRAM = """
from teachpath_client.devices import open_source
with open_source("synthetic", {}) as source:
    print(sum(1 for _ in source))
"""
HELP = """
import runpy
sys.argv = ["teachpath-client", "--help"]
runpy.run_module("teachpath_client", run_name="__main__")
"""
# Windows has none of these. pyserial and asyncio choose their parts by the system, so they are loaded before.
WINDOWS = """
import sys, asyncio, serial
for name in ("fcntl", "termios", "tty", "pty", "pwd", "grp", "resource"):
    sys.modules[name] = None
"""
WITHOUT_EMULATORS = """
import pkgutil, importlib, teachpath_client
for module in pkgutil.walk_packages(teachpath_client.__path__, "teachpath_client."):
    if not module.name.endswith(".emulators"):  # devices on pseudo-terminals, for tests
        importlib.import_module(module.name)
"""
EVENT_PEDAL = """
from teachpath_client.errors import ClientError
from teachpath_client.pedal import open_pedal
try:
    open_pedal("/dev/input/event5").__enter__()
except ClientError as error:
    print(error)
"""


@cache
def allowed() -> list[str]:
    """Return the modules that the base install brings."""
    modules = packages_distributions().items()
    brought = {name for name, owners in modules if any(canonicalize_name(owner) in required() for owner in owners)}
    return sorted(brought | {"teachpath_client", "teachpath_proto"})


def run(code: str) -> subprocess.CompletedProcess[str]:
    guard = GUARD.format(allowed=allowed())
    return subprocess.run([sys.executable, "-c", guard + code], capture_output=True, text=True, timeout=HANG)


def test_the_guard_keeps_the_service_and_its_dependencies_out() -> None:
    for name in ("teachpath", "scipy", "fastapi", "sqlalchemy", "mujoco", "annotated_types", "matplotlib"):
        ended = run(f"import {name}")
        assert ended.returncode == 1
        assert "is not in the base install" in ended.stderr


def test_every_module_of_the_client_is_imported() -> None:
    ended = run(IMPORT_PROGRAM)
    assert (ended.returncode, ended.stderr) == (0, "")


def test_the_synthetic_source_runs() -> None:
    ended = run(SYNTHETIC_PROGRAM)
    assert ended.returncode == 0, ended.stderr
    assert int(ended.stdout) > 4000


def test_the_command_line_helps() -> None:
    ended = run(HELP)
    assert ended.returncode == 0, ended.stderr
    for command in ("tracker", "sources", "glove-calibrate", "synthetic", "replay"):
        assert command in ended.stdout


@pytest.mark.parametrize("code", [WITHOUT_EMULATORS, SYNTHETIC_PROGRAM, HELP, EVENT_PEDAL])
def test_the_client_needs_no_module_that_windows_lacks(code: str) -> None:
    ended = run(WINDOWS + code)
    assert (ended.returncode, ended.stderr) == (0, "")
    if code is EVENT_PEDAL:
        assert "devices are read on Linux alone; name a key: space, enter, tab, a letter" in ended.stdout
