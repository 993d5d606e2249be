"""login: the logins of a station's bus, for trackers, drivers and programs of other users and machines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Json, settings_of
from teachpath.commands.printing import print_answer, print_list
from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath_proto.keys import is_name, name_refusal
from teachpath_proto.logins import Login, Role, write_logins

app: typer.Typer = typer.Typer(
    help="Logins on the bus: create, list, revoke. This user's own programs need none: they find theirs themselves.",
    no_args_is_help=True,
)
Name = Annotated[str, typer.Argument(help="User name on the bus.")]
RESTART = "a service that runs now hears of it at its next start"


@app.command("create")
def create(
    name: Name,
    role: Annotated[Role, typer.Option(help="What it may do on the bus.")],
    only: Annotated[str, typer.Option(help="The one tracker or robot that it may be; any unless given.")] = "",
    into: Annotated[Path | None, typer.Option(help="File to write for the other program; NAME.login.json.")] = None,
    config: Config = None,
    json_: Json = False,
) -> None:
    """Make a login for a program of another user or machine, and a file to give to it.

    The other side names the file: teachpath-client --login FILE, or Link(endpoint, login=...) in Python. Where the
    station's endpoint is over TLS, it holds a certificate instead of a password.
    """
    from teachpath.io.bus_logins import add_login, station_logins

    if role in (Role.SERVICE, Role.ROUTER):
        raise UnusableInput(f"nobody else may be the {role} of a station; use another role")
    for what, text in (("login", name), ("tracker or robot", only)):
        if text and not is_name(text):
            raise UnusableInput(name_refusal(what, text))
    settings = settings_of(config, None)
    bus = settings.bus
    if name in {login.user for login in station_logins(bus)} | {role.value for role in Role} | {"authority"}:
        raise Conflict(f"there is a login {name!r} already; revoke it first, or take another name")
    login = add_login(bus, Login(name, "", role, only))
    file = into or Path(f"{name}.login.json")
    write_logins(file, [login])
    note(settings, f"create login {name}, {role}{f', only {only}' if only else ''}")
    said = f"login {name} ({role}{f', only {only}' if only else ''}) is in {file}: keep it secret; {RESTART}"
    print_answer({"name": name, "role": role.value, "only": only, "file": str(file)}, said, json_=json_)


@app.command("list")
def list_(config: Config = None, json_: Json = False) -> None:
    """List the logins of the station, without their passwords."""
    from teachpath.io.bus_logins import station_logins

    rows = [(login.user, login.role.value, login.only) for login in station_logins(settings_of(config, None).bus)]
    print_list(
        [{"name": name, "role": role, "only": only} for name, role, only in rows],
        ("name", "role", "only"),
        rows,
        none="no logins yet; start the service once",
        json_=json_,
    )


@app.command("revoke")
def revoke(name: Name, config: Config = None, json_: Json = False) -> None:
    """Take a login back; one of this user's own programs gets a new password."""
    from teachpath.io.bus_logins import LOCAL_ROLES, revoke_login, station_logins
    from teachpath_proto.sessions import is_tls

    settings = settings_of(config, None)
    bus = settings.bus
    users = [login.user for login in station_logins(bus)]
    if name not in users:
        known = ", ".join(users) or "none; start the service once"
        raise NotFound(f"there is no login {name!r}; known: {known}")
    revoke_login(bus, name)
    note(settings, f"revoke login {name}")
    renewed = name in LOCAL_ROLES and not is_tls(bus.endpoint)
    said = f"login {name} is {'given a new password' if renewed else 'revoked'}; {RESTART}"
    print_answer({"name": name, "revoked": not renewed}, said, json_=json_)
