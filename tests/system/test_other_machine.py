"""A browser on another machine, as a network namespace is one: the station by its name, and the station's authority.

Page, WebSockets and the headset's hand need https there; nothing is told to overlook a fault of the certificate.
"""

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.passwords import hash_password
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Capability, Person
from tests.conftest import chromium, find_chromium
from tests.system.carriers import HEADSET, carry_worn, move_hand, phase
from tests.system.operators import Leader
from tests.system.processes import BUSY_SETTINGS, Command
from tests.system.visits import Visit
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

NAME, PASSWORD = "robot.teachpath.internal", "four words put together"
ASSETS = Path(__file__).parent / "assets"
THIS_ADDRESS, OTHER_ADDRESS = "10.213.0.1", "10.213.0.2"
TASK = "far"


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
            f"-n {near} addr add {THIS_ADDRESS}/30 dev line",
            f"-n {near} link set line up",
            f"-n {near} link set lo up",
            f"-n {far} addr add {OTHER_ADDRESS}/30 dev line",
            f"-n {far} link set line up",
        ):
            subprocess.run(["ip", *words.split()], check=True, timeout=HANG)
        yield names
    finally:
        for name in made:
            subprocess.run(["ip", "netns", "del", name], check=True, timeout=HANG)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with a certificate for the station's name, a task, and a person who may show and lead."""
    folder, now = tmp_path_factory.mktemp("station") / "data", time.time_ns()
    result = CliRunner().invoke(app, ["tls", "init", "--name", NAME, "--data", str(folder)])
    assert result.exception is None, result.output
    store = Store(StoreSettings(data_dir=str(folder)))
    may = (Capability.DEMONSTRATE, Capability.OPERATE)
    store.people.add(Person("anna", may, hash_password(PASSWORD, "anna"), now, now))
    store.ensure_task(TASK, scene="paper", calibration="identity")
    store.close()
    return folder


@pytest.fixture(scope="module")
def address(data: Path, namespaces: tuple[str, str]) -> Iterator[str]:
    """Where a whole station on the other end of the line answers: all of its processes are in that namespace."""
    command = Command(
        *("serve", "--data", str(data)),
        folder=data.parent,
        environment={
            **BUSY_SETTINGS,
            "TEACHPATH_AUTH__MODE": "token",
            "TEACHPATH_WEB__HOST": THIS_ADDRESS,
            "TEACHPATH_WEB__HOSTS": f'["{NAME}"]',
        },
        under=("ip", "netns", "exec", namespaces[0]),
    )
    try:
        wait_until(lambda: "teachpath serves https" in command.out, "the station serves")
        yield f"https://{NAME}:8765"
        command.process.terminate()
        assert command.wait() == 0, command.err
        command.wait_gone()
        assert "Traceback" not in command.err, command.err
    finally:
        command.clean_up()


@pytest.fixture(scope="module")
def far_browser(namespaces: tuple[str, str], data: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Chromium in a namespace of its own, which trusts the station's authority and knows the station's name."""
    home = tmp_path_factory.mktemp("home")
    trusted = home / ".pki" / "nssdb"
    trusted.mkdir(parents=True)
    authority = data / "tls" / "authority.pem"
    for words in (["-N", "--empty-password"], ["-A", "-n", "station", "-t", "C,,", "-i", str(authority)]):
        subprocess.run(["certutil", "-d", f"sql:{trusted}", *words], check=True, timeout=HANG)
    known = f"--host-resolver-rules=MAP {NAME} {THIS_ADDRESS}"
    with chromium(f"ip netns exec {namespaces[1]} {find_chromium()}", known, HOME=str(home)) as browser:
        yield browser


def sign_in(page: Any) -> None:
    page.fill("#sign-in-name", "anna")
    page.fill("#sign-in-password", PASSWORD)
    page.click("#sign-in button")


@pytest.fixture
def visit(address: str, far_browser: Any) -> Iterator[Visit]:
    """Somebody who has signed in on the other machine, with a headset on."""
    script = (ASSETS / "iwer" / "iwer.min.js").read_text() + HEADSET
    visit = Visit(far_browser, address, script=script, size=(900, 420), enter=sign_in)  # less to draw
    yield visit
    visit.page.close()


def test_a_headset_demonstrates_and_leads_the_arm_by_the_station_s_name(visit: Visit) -> None:
    page = visit.page
    page.wait_for_function("() => teachpath.state().connection === 'live'")  # both WebSockets
    assert page.evaluate("isSecureContext")
    (cookie,) = page.context.cookies()
    assert (cookie["name"], cookie["secure"]) == ("__Host-teachpath-session", True)
    page.select_option("#task", TASK)
    page.locator("#tab-demonstrate").click()
    page.get_by_label("Countdown").select_option("0")
    page.get_by_role("button", name="In a headset").click()
    phase(visit, "ready")
    carry_worn(visit, move_hand)
    phase(visit, "ready")
    page.evaluate("teachpath.headset()?.end()")
    page.get_by_role("button", name="Finish").click()
    page.wait_for_selector("html[data-session='']", state="attached")
    visit.wait(lambda: page.locator("#demonstrations .demonstration-list li").count() == 1)

    page.locator("#tab-run").click()
    Leader(visit).lead_upwards()
