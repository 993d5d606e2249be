"""The logins of a station: prepared at its start, added, revoked, and found by its programs.

On a plain endpoint they have passwords and lie in one file of this user's. Over TLS each is a certificate in the folder
`bus.certificates`; those of local programs are copied to where programs of this user look.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableSettings
from teachpath.io.bus_access import BusAccess
from teachpath.io.bus_settings import BusSettings
from teachpath_proto.logins import Login, Role, find_login, logins_path, read_logins, write_logins
from teachpath_proto.sessions import is_tls

PASSWORD_BYTES: Final = 24
# Roles whose logins lie in the file for this user's programs; the executor's is given to its process alone.
LOCAL_ROLES: Final = (Role.ROBOT, Role.TRACKER, Role.OPERATOR, Role.VIEWER)


def prepare_access(bus: BusSettings) -> BusAccess | None:
    """Return who is let onto the station's bus, and make the logins that are missing; None lets in everybody.

    Local programs find theirs in the file of `logins_path`. Passwords outlast a restart, so that a tracker comes back
    by itself. The executor's is new each time and in no file.

    Raises:
        UnusableSettings: the settings contradict each other, the logins cannot be read or written, or a certificate is
            missing or has ended; the sentence has the way out.
    """
    if is_tls(bus.endpoint):
        return _certified(bus)
    if bus.mode == "client":
        raise UnusableSettings(
            f"bus.mode is client and bus.endpoint {bus.endpoint}: a router knows programs by their certificates; set "
            "an endpoint tls/HOST:PORT, or another mode"
        )
    if not bus.access_control:
        return None
    path = logins_path(bus.endpoint)
    with _refusing(path):
        kept = [login for login in read_logins(path) if login.password]
        missing = [
            Login(role.value, new_password(), role) for role in LOCAL_ROLES if role not in {k.user for k in kept}
        ]
        if missing or not path.exists():
            write_logins(path, [*kept, *missing])
    executor = Login(Role.EXECUTOR.value, new_password(), Role.EXECUTOR)
    return BusAccess(Login(Role.SERVICE.value, new_password(), Role.SERVICE), (executor, *kept, *missing))


def _certified(bus: BusSettings) -> BusAccess:
    from teachpath.io import certificates

    if not bus.access_control:
        raise UnusableSettings(
            f"bus.access_control is false and bus.endpoint {bus.endpoint}, where certificates say who may do what; set "
            "it to true, or an endpoint tcp/127.0.0.1:PORT"
        )
    folder, path = Path(bus.certificates), logins_path(bus.endpoint)
    own = certificates.read_login(folder, Role.SERVICE.value)
    others = [login for login in certificates.read_logins(folder) if login.role is not Role.ROUTER and login != own]
    if Role.EXECUTOR not in {login.user for login in others}:
        certificates.read_login(folder, Role.EXECUTOR.value)  # says what is missing
    expiries = {login.user: certificates.expiry(login) for login in (own, *others)}
    certificates.refuse_expired((login for login in (own, *others) if login.user in set(Role)), datetime.now(UTC))
    with _refusing(path):
        write_logins(path, [login for login in others if login.user in LOCAL_ROLES and login.key])
    return BusAccess(own, tuple(others), expiries)


def station_logins(bus: BusSettings) -> list[Login]:
    """Return the logins of a station; raises UnusableSettings where they cannot be read."""
    if is_tls(bus.endpoint):
        from teachpath.io import certificates

        return certificates.read_logins(Path(bus.certificates))
    path = logins_path(bus.endpoint)
    with _refusing(path):
        return read_logins(path)


def add_login(bus: BusSettings, who: Login) -> Login:
    """Make a login for a program of another user or machine, and return it with its password or certificate.

    Raises:
        UnusableSettings: the logins cannot be read or written, or there is no authority.
    """
    if is_tls(bus.endpoint):
        from teachpath.io import certificates

        return certificates.issue(Path(bus.certificates), who, datetime.now(UTC))
    path, login = logins_path(bus.endpoint), replace(who, password=new_password())
    with _refusing(path):
        write_logins(path, [*read_logins(path), login])
    return login


def revoke_login(bus: BusSettings, name: str) -> None:
    """Take a login back; over TLS its certificate is removed, and a name without one may do nothing.

    Raises:
        UnusableSettings: the logins cannot be read or written.
    """
    if is_tls(bus.endpoint):
        for suffix in ("pem", "key"):
            (Path(bus.certificates) / f"{name}.{suffix}").unlink(missing_ok=True)
        return
    path = logins_path(bus.endpoint)
    with _refusing(path):
        write_logins(path, [login for login in read_logins(path) if login.user != name])


def local_login(bus: BusSettings, role: Role) -> Login | None:
    """Return this user's login of a role; None where the station keeps none for this user, or asks for none.

    Raises:
        UnusableSettings: it cannot be read.
    """
    folder = Path(bus.certificates)
    if not bus.access_control:
        return None
    if is_tls(bus.endpoint) and (folder / f"{role}.pem").exists():
        from teachpath.io import certificates

        return certificates.read_login(folder, role.value)
    with _refusing(logins_path(bus.endpoint)):
        return find_login(bus.endpoint, role)


def new_password() -> str:
    """Return a password that nobody guesses."""
    return secrets.token_urlsafe(PASSWORD_BYTES)


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        raise UnusableSettings(str(error)) from None
    except OSError as error:
        raise UnusableSettings(f"cannot write the logins {path}: {error.strerror}; make its folder writable") from None
