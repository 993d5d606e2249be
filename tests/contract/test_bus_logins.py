"""The logins of the bus: who comes in, and the file that has them."""

import stat
from pathlib import Path

import pytest

from teachpath.errors import UnusableSettings
from teachpath.io.bus import BusSettings
from teachpath.io.bus_logins import local_login, prepare_access
from teachpath_proto.logins import Login, Role, find_login, logins_path, read_logins, write_logins
from tests.ports import free_endpoint


def test_local_logins_are_made_once_and_only_their_owner_reads_them() -> None:
    endpoint = free_endpoint()
    first, again = prepare_access(BusSettings(endpoint)), prepare_access(BusSettings(endpoint))
    assert first is not None
    assert again is not None
    path = logins_path(endpoint)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    local = {login.user: login.password for login in read_logins(path)}
    assert set(local) == {"robot", "tracker", "operator", "viewer"}
    assert find_login(endpoint, Role.EXECUTOR) is None
    assert first.logins[1:] == again.logins[1:]
    assert first.login(Role.EXECUTOR).password != again.login(Role.EXECUTOR).password
    assert find_login(endpoint, Role.TRACKER) == first.login(Role.TRACKER)


def test_a_broken_file_of_logins_is_named(tmp_path: Path) -> None:
    path = tmp_path / "logins.json"
    write_logins(path, [Login("a", "b", Role.VIEWER)])
    path.write_text(path.read_text().replace("viewer", "king"))
    with pytest.raises(ValueError, match=f"{path} holds no logins"):
        read_logins(path)


def test_a_station_with_a_broken_file_of_logins_refuses_with_a_sentence() -> None:
    endpoint = free_endpoint()
    path = logins_path(endpoint)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("[]")
    for read in (lambda: prepare_access(BusSettings(endpoint)), lambda: local_login(BusSettings(endpoint), Role.ROBOT)):
        with pytest.raises(UnusableSettings, match=f"{path} holds no logins .* remove it and start the service again"):
            read()
