"""A station under mutual TLS with a router between its programs: who has a certificate takes part, nobody else."""

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from teachpath.io.wire import decode_state
from teachpath_client import Link
from teachpath_client.errors import ClientError
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role, read_logins
from tests.ports import free_ports
from tests.system.processes import Command, Service, run
from tests.system.test_hijacked_hand import Hand, leads, moves
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

KEYS = Keys()
ARM = "puma560"
ROUTER = (
    "import sys, zenoh; s = zenoh.open(zenoh.Config.from_file(sys.argv[1])); print('up', flush=True); sys.stdin.read()"
)
REFUSAL = 2.0  # [s] until a program that is not let in gives up
LOGINS = {
    "glove": ("tracker", "--only", "glove-1"),
    "leader": ("tracker", "--only", "glove-2"),
    "screen": ("viewer",),
    "desk": ("operator",),
}


def station_of(folder: Path, endpoint: str) -> dict[str, Login]:
    """Make certificates and router configuration as an operator does; return the logins for other machines."""
    folder.mkdir()
    bus = {"endpoint": endpoint, "certificates": str(folder / "certificates"), "mode": "client"}
    lines = [f"{name} = {json.dumps(value)}" for name, value in bus.items()]
    (folder / "station.toml").write_text("\n".join(["[bus]", *lines]))
    said(folder, "station", "certificates")
    for name, role in LOGINS.items():
        said(folder, "login", "create", name, "--role", *role)
    (folder / "zenohd.json5").write_text(said(folder, "station", "router"))
    return {name: read_logins(folder / f"{name}.login.json")[0] for name in LOGINS}


def said(folder: Path, *words: str) -> str:
    command = run(*words, "--config", "station.toml", folder=folder)
    assert command.process.returncode == 0, command.err
    return command.out


@contextmanager
def router(config: Path) -> Iterator[None]:
    """Run a Zenoh router, in place of zenohd, which the Python package does not bring."""
    process = subprocess.Popen(
        [sys.executable, "-c", ROUTER, str(config)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == b"up\n"
        yield
    finally:
        process.stdin.close()
        process.wait(HANG)
        process.stdout.close()


@contextmanager
def driver(folder: Path, certificates: Path, endpoint: str) -> Iterator[None]:
    """Run the simulated arm as on a machine of its own, which has the robot's certificate and no other."""
    own = folder / "own"
    own.mkdir(parents=True)
    for name in ("authority.pem", "robot.pem", "robot.key"):
        shutil.copy2(certificates / name, own / name)
    environment = {"TEACHPATH_BUS__ENDPOINT": endpoint, "TEACHPATH_BUS__CERTIFICATES": str(own)}
    command = Command("simulator", folder=folder, environment=environment | {"XDG_STATE_HOME": str(folder / "state")})
    try:
        yield
        command.interrupt()
        command.wait()
    finally:
        command.clean_up()


def shown(endpoint: str, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Let the client's synthetic hand show the task, as a user of another machine does."""
    line = [sys.executable, "-m", "teachpath_client", "synthetic", "--experiment", "2", "--speed", "8"]
    named = [*line, "--scene", "paper", "--endpoint", endpoint, *words]
    environment = {"XDG_STATE_HOME": str(folder / "elsewhere"), "PATH": ""}
    return subprocess.run(named, capture_output=True, text=True, timeout=HANG, env=environment, check=False)


def test_who_has_a_certificate_takes_part_and_nobody_else(tmp_path: Path) -> None:
    endpoint = f"tls/127.0.0.1:{free_ports(1)[0]}"
    logins = station_of(tmp_path / "station", endpoint)
    forged = station_of(tmp_path / "another", endpoint)
    certificates = tmp_path / "station" / "certificates"
    settings = {
        "TEACHPATH_BUS__ENDPOINT": endpoint,
        "TEACHPATH_BUS__MODE": "client",
        "TEACHPATH_BUS__CERTIFICATES": str(certificates),
        "TEACHPATH_SIMULATOR__START": "false",
    }
    with (
        router(tmp_path / "station" / "zenohd.json5"),
        Service(tmp_path / "served" / "data", **settings) as service,
        driver(tmp_path / "driver", certificates, endpoint),
        Link(endpoint, login=logins["desk"]) as desk,
    ):
        service.station.wait_for_arm(timeout=HANG)
        refused = shown(endpoint, tmp_path)
        assert refused.returncode == 1
        assert "teachpath login create NAME --role tracker" in refused.stderr
        for stranger in (None, *forged.values()):
            with pytest.raises(ClientError, match="no station at tls"):
                Link(endpoint, login=stranger or Login("glove", "guessed", Role.TRACKER), timeout=REFUSAL)
        showing = shown(endpoint, tmp_path, "--login", str(tmp_path / "station" / "glove.login.json"))
        assert showing.returncode == 0, showing.stderr
        assert len(service.station.demonstrations("demo")) == 5
        follow(service, desk, endpoint, logins)


def follow(service: Service, desk: Link, endpoint: str, logins: dict[str, Login]) -> None:
    """Let the hand lead the arm of the other machine, while a viewer publishes setpoints, which nobody hears."""
    positions: list[np.ndarray] = []
    setpoints: list[bytes] = []
    desk.subscribe(KEYS.state(ARM), lambda payload: positions.append(decode_state(payload).position))
    desk.subscribe(KEYS.setpoint(ARM), setpoints.append)
    with (
        Link(endpoint, login=logins["leader"]) as leader,
        Link(endpoint, login=logins["screen"]) as screen,
        Hand() as hand,
    ):
        hand.put = leader.publisher(KEYS.samples("glove-2")).put
        led = service.station.begin_teleoperation("glove-2", scene="empty")
        wait_until(lambda: "press the clutch" in service.station.get_execution(led.id).status.reason, "it waits")
        wait_until(lambda: leads(hand, service.station, led.id), "the hand leads")
        wait_until(lambda: moves(hand, service.station, led.id, positions), "the arm follows it")
        screen.publisher(KEYS.setpoint(ARM)).put(b"mine")
        screen.publisher(KEYS.executor_stop).put(b"")  # which a viewer may, so the setpoint has come before it
        wait_until(lambda: service.station.get_execution(led.id).status.state == "ended", "the viewer stops the arm")
    assert setpoints
    assert b"mine" not in setpoints
