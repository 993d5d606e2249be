"""station: the certificates of a bus over TLS, and the configuration of a router."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Json, settings_of
from teachpath.commands.printing import print_answer
from teachpath.errors import UnusableInput
from teachpath_proto.logins import Login, Role, write_logins

if TYPE_CHECKING:
    from teachpath.io.bus_settings import BusSettings

app: typer.Typer = typer.Typer(help="A bus over several machines: its certificates, its router.", no_args_is_help=True)
Host = Annotated[
    list[str] | None,
    typer.Option("--host", help="Further address or name at which the service or router listens; repeatable."),
]


@app.command("certificates")
def certificates(
    host: Host = None,
    renew: Annotated[bool, typer.Option("--renew", help="Renew all, not only those that end within 30 days.")] = False,
    config: Config = None,
    json_: Json = False,
) -> None:
    """Make the authority and the certificates of all roles, or renew those that end soon.

    They lie in the folder `bus.certificates`, keys with mode 0600. Another machine needs its own NAME.pem and NAME.key,
    and authority.pem, in a folder of that kind; programs that are given a file by `teachpath login create` need that
    alone. authority.key is needed here only: keep it where nobody else comes.
    """
    from teachpath.io import certificates as files
    from teachpath.io.bus_access import RENEWAL

    settings, now = settings_of(config, None), datetime.now(UTC)
    bus = settings.bus
    folder = Path(bus.certificates)
    sentences = []
    if made_authority := files.prepare_authority(folder, now):
        sentences.append(f"authority made; whoever has {folder}/authority.key can make certificates of the station")
    there = {login.user: login for login in files.read_logins(folder)}
    server = Role.ROUTER if bus.mode == "client" else Role.SERVICE
    roles = [role for role in Role if role is not Role.ROUTER or server is role]
    wanted = {role.value: Login(role.value, "", role) for role in roles} | there
    issued, held = [], []
    for name, login in wanted.items():
        hosts = _hosts(bus, there.get(name), host or []) if name == server else []
        has_hosts = name not in there or set(hosts) <= set(files.hosts_of(there[name]))
        if name in there and has_hosts and not renew and files.expiry(login) - now > RENEWAL:
            held.append(_held(name, "as before", login))
            sentences.append(f"{name}: valid until {files.expiry(login):%Y-%m-%d}")
            continue
        made = files.issue(folder, login, now, hosts=hosts)
        issued.append(name)
        state = "renewed" if name in there else "made"
        held.append(_held(name, state, made))
        sentences.append(f"{name}: {state}, valid until {files.expiry(made):%Y-%m-%d}")
        if made.role.value != name:
            write_logins(file := folder / f"{name}.login.json", [made])
            sentences.append(f"  give {file} to it")
    note(settings, f"make certificates of the bus: {', '.join(issued) or 'none'}")
    sentences.append("what runs now goes on with the old ones until it is started again")
    said = {"folder": str(folder), "authority_made": made_authority, "certificates": held}
    print_answer(said, *sentences, json_=json_)


@app.command("router")
def router(config: Config = None) -> None:
    """Print the configuration of a Zenoh router for this station: teachpath station router > zenohd.json5."""
    from teachpath.io import certificates as files
    from teachpath.io.router_config import router_config
    from teachpath_proto.sessions import is_tls

    bus = settings_of(config, None).bus
    if not (bus.mode == "client" and is_tls(bus.endpoint)):
        raise UnusableInput(
            f'the station joins no router: set bus.mode = "client" and bus.endpoint = "tls/HOST:7447"; now it is '
            f"{bus.mode} at {bus.endpoint}"
        )
    files.read_login(Path(bus.certificates), Role.ROUTER.value)  # says how it is made where it is not there
    print(router_config(bus, files.read_logins(Path(bus.certificates))), end="")


def _held(name: str, state: str, login: Login) -> dict[str, object]:
    from teachpath.io.certificates import expiry

    return {"name": name, "state": state, "expires_ns": round(expiry(login).timestamp()) * 1_000_000_000}


def _hosts(bus: BusSettings, there: Login | None, further: list[str]) -> list[str]:
    """Return where the holder of a certificate listens: loopback, the endpoint, what it had before, and more."""
    from teachpath.io import certificates as files

    place = bus.endpoint.partition("/")[2].partition("?")[0].rpartition(":")[0].strip("[]")
    before = files.hosts_of(there) if there else []
    return [*files.LOOPBACK, *([place] if place else []), *before, *further]
