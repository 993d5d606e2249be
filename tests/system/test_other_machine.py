"""A browser on another machine, as a network namespace is one: the station by its name, and the station's authority.

Page, WebSockets and the headset's hand need https there; nothing is told to overlook a fault of the certificate.
"""

import ctypes
import os
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.passwords import hash_password
from teachpath.app import Station
from teachpath.commands.serving import listen
from teachpath.records import Capability, Person
from teachpath.web.server import web_server
from tests.conftest import chromium, find_chromium
from tests.contract import stations
from tests.ports import free_port
from tests.system.carriers import HEADSET
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

NAME, PASSWORD = "robot.teachpath.internal", "four words put together"
ASSETS = Path(__file__).parent / "assets"
HERE, THERE = "10.213.0.1", "10.213.0.2"
CLONE_NEWNET = 0x40000000  # of Linux' setns


@pytest.fixture(scope="module")
def namespaces() -> Iterator[tuple[str, str]]:
    """Two network namespaces with a line between them: the station's and the browser's.

    This machine's own sees nothing of it: a browser there breaks off its requests when a line of its machine changes.
    """
    missing = [program for program in ("ip", "certutil") if shutil.which(program) is None]
    if missing:
        pytest.skip(f"no {' and no '.join(missing)}; get them with: sudo apt-get install iproute2 libnss3-tools")
    near, far = names = f"teachpath-{os.getpid()}-near", f"teachpath-{os.getpid()}-far"
    made: list[str] = []
    try:
        for name in names:
            if subprocess.run(["ip", "netns", "add", name], capture_output=True).returncode:
                pytest.skip(
                    "only root may make a network namespace: run the tests as root, or in a container of its own"
                )
            made.append(name)
        for words in (
            f"-n {near} link add line type veth peer name line netns {far}",
            f"-n {near} addr add {HERE}/30 dev line",
            f"-n {near} link set line up",
            f"-n {far} addr add {THERE}/30 dev line",
            f"-n {far} link set line up",
        ):
            subprocess.run(["ip", *words.split()], check=True, timeout=HANG)
        yield names
    finally:
        for name in made:
            subprocess.run(["ip", "netns", "del", name], check=True, timeout=HANG)


def listen_in(namespace: str, port: int) -> socket.socket:
    """Listen in a network namespace; a socket stays in that of the thread that made it."""

    def make() -> socket.socket:
        with open(f"/run/netns/{namespace}") as file:
            if ctypes.CDLL(None, use_errno=True).setns(file.fileno(), CLONE_NEWNET):
                raise OSError(ctypes.get_errno(), f"cannot enter the network namespace {namespace}")
        return listen(HERE, port)

    with ThreadPoolExecutor(1) as thread:  # which ends, and its namespace with it
        return thread.submit(make).result()


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with a certificate for the station's name."""
    folder = tmp_path_factory.mktemp("station") / "data"
    result = CliRunner().invoke(app, ["tls", "init", "--name", NAME, "--data", str(folder)])
    assert result.exception is None, result.output
    return folder


@pytest.fixture(scope="module")
def station(data: Path, namespaces: tuple[str, str]) -> Iterator[tuple[Station, str]]:
    """A station that listens on the line, with a person who may show how it is done; and its address."""
    with stations.station_in(data, auth={"mode": "token"}, web={"host": HERE, "hosts": [NAME]}) as station:
        now = time.time_ns()
        kept = hash_password(PASSWORD, "anna")
        station.store.people.add(Person("anna", (Capability.DEMONSTRATE,), kept, now, now))
        station.access.refresh()
        station.store.ensure_task("far", scene="paper", calibration="identity")
        assert station.certificate
        port = free_port()
        server = web_server(station.web, station.settings.web, station.certificate.context)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listen_in(namespaces[0], port)]}, daemon=True)
        thread.start()
        wait_until(lambda: server.started, "the server has started")
        yield station, f"https://{NAME}:{port}"
        open_ = server.server_state
        wait_until(lambda: not open_.connections and not open_.tasks, "the browser's connections have ended")
        server.should_exit = True
        thread.join(HANG)


@pytest.fixture(scope="module")
def far_browser(namespaces: tuple[str, str], data: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Chromium in a namespace of its own, which trusts the station's authority and knows the station's name."""
    home = tmp_path_factory.mktemp("home")
    trusted = home / ".pki" / "nssdb"
    trusted.mkdir(parents=True)
    authority = data / "tls" / "authority.pem"
    for words in (["-N", "--empty-password"], ["-A", "-n", "station", "-t", "C,,", "-i", str(authority)]):
        subprocess.run(["certutil", "-d", f"sql:{trusted}", *words], check=True, timeout=HANG)
    known = f"--host-resolver-rules=MAP {NAME} {HERE}"
    with chromium(f"ip netns exec {namespaces[1]} {find_chromium()}", known, HOME=str(home)) as browser:
        yield browser


def test_page_websockets_and_headset_work_by_the_station_s_name(station: tuple[Station, str], far_browser: Any) -> None:
    running, address = station
    page = far_browser.new_page(viewport={"width": 900, "height": 420})  # less to draw
    page.set_default_timeout(1000 * HANG)
    page.add_init_script((ASSETS / "iwer" / "iwer.min.js").read_text() + HEADSET)
    page.goto(address)
    page.fill("#sign-in-name", "anna")
    page.fill("#sign-in-password", PASSWORD)
    page.click("#sign-in button")
    page.wait_for_function("() => teachpath.state().connection === 'live'")  # both WebSockets
    assert page.evaluate("isSecureContext")
    (cookie,) = page.context.cookies()
    assert (cookie["name"], cookie["secure"]) == ("__Host-teachpath-session", True)
    page.select_option("#task", "far")
    page.locator("#tab-demonstrate").click()
    page.get_by_label("Countdown").select_option("0")
    page.get_by_role("button", name="In a headset").click()
    page.wait_for_selector("html[data-session=ready]", state="attached")

    def is_recorded() -> bool:
        return any(s.statistics.received > 20 for s in running.recorder.statuses(with_statistics=True) if s.statistics)

    wait_until(
        is_recorded, "the headset's hand is recorded", pause=lambda seconds: page.wait_for_timeout(5000 * seconds)
    )
    page.close()
