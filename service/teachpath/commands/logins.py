"""login: the logins of a station's bus, for trackers, drivers and programs of other users and machines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from teachpath.commands.options import Config, settings_of
from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.bus_access import LOCAL, new_password
from teachpath_proto.keys import is_name, name_refusal
from teachpath_proto.logins import Login, Role, logins_path, read_logins, write_logins

app = typer.Typer(
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
) -> None:
    """Make a login for a program of another user or machine, and a file to give to it.

    The other side names the file: teachpath-client --login FILE, or Link(endpoint, login=...) in Python.
    """
    for what, text in (("login", name), ("tracker or robot", only)):
        if text and not is_name(text):
            raise UnusableInput(name_refusal(what, text))
    path, logins = _logins(config)
    if name in {login.user for login in logins} | {role.value for role in Role} | {"service"}:
        raise Conflict(f"there is a login {name!r} already; revoke it first, or take another name")
    login = Login(name, new_password(), role, only)
    write_logins(path, [*logins, login])
    file = into or Path(f"{name}.login.json")
    write_logins(file, [login])
    print(f"login {name} ({role}{f', only {only}' if only else ''}) is in {file}: keep it secret; {RESTART}")


@app.command("list")
def list_(config: Config = None) -> None:
    """List the logins of the station, without their passwords."""
    table = Table("name", "role", "only")
    for login in _logins(config)[1]:
        table.add_row(login.user, login.role.value, login.only)
    Console().print(table)


@app.command("revoke")
def revoke(name: Name, config: Config = None) -> None:
    """Take a login back; one of this user's own programs gets a new password."""
    path, logins = _logins(config)
    if name not in {login.user for login in logins}:
        known = ", ".join(login.user for login in logins) or "none; start the service once"
        raise NotFound(f"there is no login {name!r}; known: {known}")
    write_logins(path, [login for login in logins if login.user != name])
    renewed = name in {role.value for role in LOCAL}
    print(f"login {name} is {'given a new password' if renewed else 'revoked'}; {RESTART}")


def _logins(config: Path | None) -> tuple[Path, list[Login]]:
    path = logins_path(settings_of(config, None).bus.endpoint)
    try:
        return path, read_logins(path)
    except ValueError as error:
        raise UnusableInput(str(error)) from None
