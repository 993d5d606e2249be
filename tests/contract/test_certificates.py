"""A bus over TLS, on real sockets: what each certificate may do, and how certificates are made and renewed."""

import json
import queue
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.config import load
from teachpath.errors import TeachpathError, Unreachable, UnusableSettings
from teachpath.io import certificates
from teachpath.io.bus import Bus, listen_on_bus, open_bus
from teachpath.io.bus_logins import local_login, prepare_access, station_logins
from teachpath.io.bus_settings import BusSettings
from teachpath_client import Link
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role, read_logins
from teachpath_proto.sessions import listening, listening_over_tls, open_session
from tests.contract import router_file
from tests.ports import free_endpoint
from tests.waiting import HANG, wait_until

KEYS = Keys()
CURRENT_TIME = datetime.now(UTC)
REFUSAL = 1.0  # [s] until a client that is not let in gives up
SETPOINT, STATE = KEYS.setpoint("puma560"), KEYS.state("puma560")


def said(folder: Path, *words: str) -> str:
    """Run a command of the station whose settings are in `folder`."""
    result = CliRunner().invoke(app, [*words, "--config", str(folder / "station.toml")])
    if isinstance(result.exception, TeachpathError):
        raise result.exception
    assert result.exception is None, result.output
    return result.stdout


def prepared(folder: Path, **settings: object) -> BusSettings:
    """Make the certificates of a station as its operator does, and return its settings."""
    endpoint = free_endpoint().replace("tcp/", "tls/")
    given = {"endpoint": endpoint, "certificates": str(folder / "certificates"), **settings}
    lines = "\n".join(f"{name} = {json.dumps(value)}" for name, value in given.items())
    (folder / "station.toml").write_text(f"[bus]\n{lines}\n")
    said(folder, "station", "certificates")
    said(folder, "login", "create", "left", "--role", "tracker", "--only", "left", "--into", str(folder / "left.json"))
    return load(folder / "station.toml").bus


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("station")


@pytest.fixture(scope="module")
def bus(folder: Path) -> BusSettings:
    return prepared(folder)


@pytest.fixture(scope="module")
def service(bus: BusSettings) -> Iterator[Bus]:
    service = listen_on_bus(bus, prepare_access(bus))
    yield service
    service.close()


def login(bus: BusSettings, name: str) -> Login:
    return certificates.read_login(Path(bus.certificates), name)


@contextmanager
def joined(bus: BusSettings, login: Login | None) -> Iterator[Bus]:
    client = open_bus(bus, login)
    try:
        yield client
    finally:
        client.close()


def heard_from(service: Bus, client: Bus, allowed: str, *denied: str) -> set[str]:
    """Let a client put on all keys, until the allowed one is heard; return what is heard."""
    heard: queue.Queue[str] = queue.Queue()
    handles = [service.subscribe(key, lambda key, _: heard.put(key)) for key in (*denied, allowed)]

    def arrives() -> bool:
        for key in (*denied, allowed):
            client.publish(key, b"mine")
        try:
            return heard.get(timeout=0.05) == allowed or not heard.empty()
        except queue.Empty:
            return False

    wait_until(arrives, f"{allowed} is heard")
    for handle in handles:
        handle.close()
    return {allowed} | {heard.get() for _ in range(heard.qsize())}


def test_each_certificate_may_do_what_its_role_may(bus: BusSettings, service: Bus, folder: Path) -> None:
    with joined(bus, login(bus, "executor")) as client:
        assert heard_from(service, client, SETPOINT, STATE) == {SETPOINT}
    with joined(bus, local_login(bus, Role.ROBOT)) as client:
        assert heard_from(service, client, STATE, SETPOINT) == {STATE}
    (left,) = read_logins(folder / "left.json")
    mine, others = KEYS.samples("left"), KEYS.samples("right")
    with joined(bus, left) as client:
        assert heard_from(service, client, mine, others, SETPOINT) == {mine}


def test_a_client_of_this_user_finds_its_certificate_by_itself(bus: BusSettings, service: Bus) -> None:
    handle = service.serve(KEYS.recorder_status, lambda _: b"here")
    with Link(bus.endpoint, role=Role.TRACKER) as link:
        assert link.ask(KEYS.recorder_status) == b"here"
    handle.close()


def of_another_authority(bus: BusSettings, folder: Path) -> Login:
    """The executor's name and role, signed by an authority of somebody else's, that knows the station's for its own."""
    certificates.prepare_authority(folder, CURRENT_TIME)
    forged = certificates.issue(folder, Login("executor", "", Role.EXECUTOR), CURRENT_TIME)
    return replace(forged, authority=login(bus, "executor").authority)


def of_yesterday(bus: BusSettings, folder: Path) -> Login:
    return certificates.issue(
        Path(bus.certificates), Login("past", "", Role.EXECUTOR), CURRENT_TIME - 2 * certificates.LIFE
    )


def without_certificate(bus: BusSettings, folder: Path) -> Login:
    """A password, where certificates are asked for."""
    return Login("executor", "guessed", Role.EXECUTOR)


@pytest.mark.parametrize("forged", [of_another_authority, of_yesterday, without_certificate])
def test_who_shows_no_certificate_of_the_station_is_not_let_in(
    bus: BusSettings, service: Bus, tmp_path: Path, forged: object
) -> None:
    assert callable(forged)
    with pytest.raises(Unreachable, match="is the login one of its own"):
        open_bus(replace(bus, connect_timeout=REFUSAL), forged(bus, tmp_path))
    (Path(bus.certificates) / "past.pem").unlink(missing_ok=True)


def test_a_stolen_certificate_of_a_client_cannot_play_the_station(bus: BusSettings) -> None:
    tracker, endpoint = login(bus, "tracker"), free_endpoint().replace("tcp/", "tls/")
    impostor = open_session({**listening([endpoint]), **listening_over_tls(tracker)})
    try:
        with pytest.raises(Unreachable):
            open_bus(replace(bus, endpoint=endpoint, connect_timeout=REFUSAL), login(bus, "executor"))
    finally:
        impostor.close()  # type: ignore[no-untyped-call]


def test_a_name_whose_certificate_was_revoked_may_do_nothing(tmp_path: Path) -> None:
    bus = prepared(tmp_path)
    (left,) = read_logins(tmp_path / "left.json")
    assert "revoked" in said(tmp_path, "login", "revoke", "left")
    service = listen_on_bus(bus, prepare_access(bus))
    try:
        with joined(bus, left) as revoked, joined(bus, login(bus, "executor")) as client:
            heard: queue.Queue[str] = queue.Queue()
            service.subscribe(KEYS.samples("left"), lambda key, _: heard.put(key))
            for _ in range(3):
                revoked.publish(KEYS.samples("left"), b"revoked")
                assert heard_from(service, client, SETPOINT) == {SETPOINT}
            assert heard.empty()
    finally:
        service.close()


def test_a_name_that_is_issued_anew_gives_nothing_to_who_has_its_revoked_certificate(tmp_path: Path) -> None:
    bus = prepared(tmp_path)
    (old,) = read_logins(tmp_path / "left.json")
    said(tmp_path, "login", "revoke", "left")
    said(tmp_path, "login", "create", "left", "--role", "tracker", "--only", "left", "--into", str(tmp_path / "2.json"))
    (new,) = read_logins(tmp_path / "2.json")
    said(tmp_path, "station", "certificates", "--renew")
    assert login(bus, "left").common_name == new.common_name != old.common_name
    service = listen_on_bus(bus, prepare_access(bus))
    try:
        with joined(bus, old) as revoked, joined(bus, new) as again:
            heard: queue.Queue[bytes] = queue.Queue()
            service.subscribe(KEYS.samples("left"), lambda _, payload: heard.put(payload))
            for _ in range(3):
                revoked.publish(KEYS.samples("left"), b"revoked")
                assert heard_from(service, again, KEYS.samples("left")) == {KEYS.samples("left")}
            assert b"revoked" not in {heard.get() for _ in range(heard.qsize())}
    finally:
        service.close()


def test_a_certificate_that_was_removed_by_hand_or_without_a_ledger_is_followed_by_a_further_one(
    tmp_path: Path,
) -> None:
    bus = prepared(tmp_path)
    folder = Path(bus.certificates)

    def issued_again() -> Login:
        for suffix in ("pem", "key"):
            (folder / f"executor.{suffix}").unlink()
        said(tmp_path, "station", "certificates")
        return login(bus, "executor")

    assert login(bus, "executor").common_name == "executor"
    assert [issued_again().generation, issued_again().generation] == [2, 3]
    (folder / certificates.ISSUED_FILE).unlink()
    assert issued_again().common_name != "executor"
    (folder / certificates.ISSUED_FILE).write_text("[1")
    (folder / "executor.pem").unlink()
    with pytest.raises(UnusableSettings, match=r"issued.json does not say .* remove it"):
        said(tmp_path, "station", "certificates")


def test_over_a_router_each_certificate_may_do_the_same(tmp_path: Path) -> None:
    bus = prepared(tmp_path, mode="client")
    text = said(tmp_path, "station", "router")
    document = json.loads("\n".join(line for line in text.splitlines() if not line.startswith("//")))
    router = open_session(document)
    try:
        access = prepare_access(bus)
        service = listen_on_bus(bus, access)
        with joined(bus, login(bus, "executor")) as executor, joined(bus, login(bus, "viewer")) as viewer:
            assert heard_from(service, executor, SETPOINT, STATE) == {SETPOINT}
            assert heard_from(service, viewer, KEYS.executor_stop, SETPOINT, STATE) == {KEYS.executor_stop}
            alive: queue.Queue[str] = queue.Queue()
            service.watch(KEYS.all_alive, lambda key, _: alive.put(key))
            executor.announce(KEYS.alive("executor", "puma560"))
            assert alive.get(timeout=HANG) == KEYS.alive("executor", "puma560")
        service.close()
    finally:
        router.close()  # type: ignore[no-untyped-call]


def test_the_routers_file_in_deploy_is_written_from_the_table() -> None:
    assert router_file.FILE.read_text() == router_file.text(), "run: python -m tests.contract.router_file"


def test_keys_are_for_their_owner_alone_and_one_that_others_may_read_is_refused(tmp_path: Path) -> None:
    bus = prepared(tmp_path)
    folder = Path(bus.certificates)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert {stat.S_IMODE(file.stat().st_mode) for file in folder.iterdir()} == {0o600}
    (folder / "executor.key").chmod(0o640)
    with pytest.raises(UnusableSettings, match=r"executor.key \(mode 0640.* make another: teachpath station"):
        prepare_access(bus)


def test_a_certificate_is_renewed_in_time_and_a_station_without_one_says_how_to_get_it(tmp_path: Path) -> None:
    bus = prepared(tmp_path)
    folder, soon = Path(bus.certificates), CURRENT_TIME - certificates.LIFE + timedelta(days=20)
    access = prepare_access(bus)
    assert access is not None
    assert access.notes(CURRENT_TIME) == []
    for one in (login(bus, "tracker"), login(bus, "left")):
        certificates.issue(folder, one, soon)
    access = prepare_access(bus)
    assert access is not None
    assert [note.split(" ends on ")[0] for note in access.notes(CURRENT_TIME)] == [
        "the certificate of left",
        "the certificate of tracker",
    ]
    answer = said(tmp_path, "station", "certificates", "--host", "lab.example")
    assert {line.split(":")[0] for line in answer.splitlines() if ": renewed" in line} == {"left", "tracker", "service"}
    assert (folder / "left.login.json").exists()
    assert certificates.hosts_of(login(bus, "service")) == ["127.0.0.1", "lab.example", "localhost"]
    certificates.issue(folder, login(bus, "executor"), CURRENT_TIME - 2 * certificates.LIFE)
    with pytest.raises(UnusableSettings, match=r"certificate of executor ended on .* renew it with: teachpath station"):
        prepare_access(bus)
    (folder / "executor.pem").unlink()
    with pytest.raises(UnusableSettings, match=r"there is no .*executor.pem; .* teachpath station certificates"):
        prepare_access(bus)
    assert {one.user for one in station_logins(bus)} == {"service", "robot", "tracker", "operator", "viewer", "left"}


def test_an_authority_signs_nothing_that_would_outlive_it(tmp_path: Path) -> None:
    certificates.prepare_authority(tmp_path, CURRENT_TIME)
    end = CURRENT_TIME + certificates.AUTHORITY_LIFE
    who = Login("executor", "", Role.EXECUTOR)
    late = certificates.issue(tmp_path, who, end - timedelta(days=40))
    assert certificates.expiry(late) <= end
    with pytest.raises(UnusableSettings, match=r"ends on .* move the folder away, then make all certificates anew"):
        certificates.issue(tmp_path, who, end - timedelta(days=20))
