"""person: the people who sign in with a password, for a station that asks who somebody is (auth.mode)."""

from __future__ import annotations

import sys
import time
from collections import Counter
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, opened_store, settings_of
from teachpath.commands.printing import print_answer, print_list
from teachpath.commands.tokens import capabilities
from teachpath.errors import UnusableInput
from teachpath_proto.keys import is_name, name_refusal

if TYPE_CHECKING:
    from teachpath.records import Person

app: typer.Typer = typer.Typer(
    help="People who sign in on the page: add, list, password, remove.", no_args_is_help=True
)
Name = Annotated[str, typer.Argument(help="Under which the person signs in; the journal has it.")]


@app.command("add")
def add(
    name: Name,
    role: Annotated[list[str], typer.Option(help="What the person may do; may be repeated (docs/access.md).")],
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Add a person, who signs in a second later; the password is asked for, or read from the standard input."""
    from teachpath.access.passwords import hash_password
    from teachpath.records import Person

    if not is_name(name):
        raise UnusableInput(name_refusal("person", name))
    kept, now = hash_password(_password(name), name), time.time_ns()
    settings = settings_of(config, data)
    with opened_store(settings) as store:
        store.people.add(person := Person(name, capabilities(role), kept, now, now))
    note(settings, f"add person {name}, {' '.join(role)}")
    print_answer(_described(person, 0), f"{name} may {', '.join(role)}", json_=json_)
    if settings.auth.mode == "oidc":
        print(f"People sign in at {settings.oidc.name} now: {name} can when auth.mode is token.", file=sys.stderr)


@app.command("password")
def password(name: Name, config: Config = None, data: Data = None, json_: Json = False) -> None:
    """Give a person another password; every session begun with the former one ends within a second."""
    from teachpath.access.passwords import hash_password

    kept = hash_password(_password(name), name)
    settings = settings_of(config, data)
    with opened_store(settings) as store:
        store.people.change_password(name, kept, time.time_ns())
    note(settings, f"change the password of {name}")
    print_answer({"name": name, "sessions": 0}, f"{name} has another password", json_=json_)


@app.command("list")
def list_(config: Config = None, data: Data = None, json_: Json = False) -> None:
    """List the people, and how many sessions each has."""
    with opened_store(settings_of(config, data)) as store:
        sessions = Counter(session.person for session in store.people.sessions())
        known = store.people.all()
    rows = [
        (
            one.name,
            " ".join(one.roles),
            f"{datetime.fromtimestamp(one.created_ns / 1e9, UTC):%Y-%m-%d}",
            sessions[one.name],
        )
        for one in known
    ]
    print_list(
        [_described(one, sessions[one.name]) for one in known],
        ("name", "roles", "added", "sessions"),
        rows,
        none="nobody yet: teachpath person add NAME",
        json_=json_,
    )


@app.command("remove")
def remove(name: Name, config: Config = None, data: Data = None, json_: Json = False) -> None:
    """Remove a person; every session ends within a second, and so does what was opened in it."""
    settings = settings_of(config, data)
    with opened_store(settings) as store:
        store.people.remove(name)
    note(settings, f"remove person {name}")
    print_answer({"name": name, "removed": True}, f"{name} is removed", json_=json_)


def _described(person: Person, sessions: int) -> dict[str, object]:
    """Return what anybody may know of a person: no hash."""
    return {"name": person.name, "roles": list(person.roles), "created_ns": person.created_ns, "sessions": sessions}


def _password(name: str) -> str:
    if sys.stdin.isatty():
        asked: str = typer.prompt(f"Password of {name}", hide_input=True, confirmation_prompt=True)
        return asked
    return sys.stdin.readline().rstrip("\n")
