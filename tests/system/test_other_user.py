"""Another Unix user of the machine, with a tracker's login of its own, moves nothing and reads nothing."""

import json
import os
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from teachpath.io.bus import open_bus
from teachpath.io.bus_settings import BusSettings
from teachpath.io.wire import decode_state
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role, read_logins
from tests.ports import free_ports
from tests.system.processes import Command, Service, confirmed
from tests.waiting import HANG, wait_until

pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(os.name == "nt" or os.geteuid() != 0, reason="only root may become another user"),
]
KEYS = Keys()
STILL_TOLERANCE = 1e-3  # [rad] that an arm at rest gives way


@pytest.fixture(scope="module")
def place() -> Iterator[Path]:
    """A folder that everybody may enter, as /home and /srv are; the test's own folders would hide all by themselves."""
    with tempfile.TemporaryDirectory(prefix="teachpath-open-") as folder:
        Path(folder).chmod(0o755)
        (Path(folder) / "for everybody").write_text("so that what cannot be read is not hidden by the folder")
        yield Path(folder)


@pytest.fixture(scope="module")
def visitor(place: Path) -> tuple[tuple[int, int], Login]:
    """Ports of a station, and the login that its operator made for a tracker of another user."""
    web, bus = free_ports(2)
    file = place / "visitor.json"
    environment = {"TEACHPATH_BUS__ENDPOINT": f"tcp/127.0.0.1:{bus}", "XDG_STATE_HOME": str(place / "state")}
    words = ("login", "create", "visitor", "--role", "tracker", "--only", "visitor", "--into", str(file))
    command = Command(*words, folder=place, environment=environment)
    assert command.wait() == 0, command.err
    (login,) = read_logins(file)
    return (web, bus), login


@pytest.fixture(scope="module")
def service(place: Path, visitor: tuple[tuple[int, int], Login]) -> Iterator[Service]:
    with Service(place / "data", ports=visitor[0], XDG_STATE_HOME=str(place / "state")) as service:
        service.station.wait_for_arm(timeout=HANG)
        yield service


@contextmanager
def other_user(given: dict[str, Any]) -> Iterator[subprocess.Popen[str]]:
    """Start the attacker; it ends with the test."""
    command = [sys.executable, "-m", "tests.system.other_user"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        process.stdin.write(json.dumps(given) + "\n")
        process.stdin.flush()
        try:
            yield process
        finally:
            process.kill()


def said(process: subprocess.Popen[str]) -> Any:
    assert process.stdout is not None
    return json.loads(process.stdout.readline())


def secrets(service: Service, place: Path) -> list[str]:
    """Return every file of the station, and what its processes were given and hold."""
    files = [str(file) for folder in ("data", "state") for file in (place / folder).rglob("*") if file.is_file()]
    assert {"teachpath.sqlite", f"tcp-127.0.0.1-{service.ports[1]}.json", f"tcp-127.0.0.1-{service.ports[1]}.key"} <= {
        Path(file).name for file in files
    }
    pids = [pid for words in ("teachpath", "forkserver") for pid in service.find(words)]
    return files + [f"/proc/{pid}/{file}" for pid in pids for file in ("fd/0", "environ", "mem")]


def test_what_the_station_keeps_is_for_its_user_alone(service: Service, place: Path) -> None:
    assert stat.S_IMODE((place / "data").stat().st_mode) == 0o700
    shared = []
    for file in (place / "data").rglob("*"):
        with suppress(FileNotFoundError):  # of a probe of the disk, which the service just removed
            shared += [file] if file.stat().st_mode & 0o077 else []
    assert shared == []


def test_another_user_of_the_machine_reads_nothing_and_moves_nothing(
    service: Service, place: Path, visitor: tuple[tuple[int, int], Login]
) -> None:
    everybody = str(place / "for everybody")
    kept = next((place / "state" / "teachpath").glob("*.json"))
    operator = next(login for login in read_logins(kept) if login.role is Role.OPERATOR)
    given = {"files": [everybody, *secrets(service, place)], "endpoint": service.endpoint, "login": asdict(visitor[1])}
    bus = open_bus(BusSettings(service.endpoint), operator)
    heard: list[str] = []
    positions: list[Any] = []
    try:
        for key in (KEYS.setpoint("puma560"), KEYS.samples("hand")):
            bus.subscribe(key, lambda key, _: heard.append(key))
        bus.subscribe(KEYS.state("puma560"), lambda _, payload: positions.append(decode_state(payload).position))
        with other_user(given) as attacker:
            assert said(attacker) == {"read": [everybody], "let in": []}
            assert said(attacker) == "ready"
            for _ in range(5):
                confirmed(service.station.stop_arm)  # returns when the executor's own status shows it
            lease(service)
            seen = len(positions)
            wait_until(lambda: len(positions) > seen + 20, "the arm speaks on")
            assert attacker.stdin is not None
            attacker.stdin.close()
            assert said(attacker) == {"swallowed": [], "tapped": [], "answered": []}
    finally:
        bus.close()
    assert heard == []
    assert np.ptp(positions, axis=0).max() < STILL_TOLERANCE


def lease(service: Service) -> None:
    """Take control, say that one is there, and give it back: the token passes over the bus."""
    url = f"{service.url}/api/v1/lease"
    with httpx.Client(timeout=HANG, trust_env=False) as client:
        token = client.post(url, json={"name": "operator", "seconds": 60.0}).raise_for_status().json()["token"]
        for action in ("beat", "release"):
            client.post(f"{url}/{action}", headers={"Teachpath-Lease": token}).raise_for_status()
