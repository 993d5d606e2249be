"""token: the tokens of programs, for a station that asks who somebody is (auth.mode)."""

from __future__ import annotations

import sys
import time
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, opened_store, settings_of
from teachpath.commands.printing import print_answer, print_list
from teachpath.errors import UnusableInput
from teachpath_proto.keys import is_name, name_refusal
from teachpath_proto.tokens import TOKEN_VARIABLE, token_path, write_token

if TYPE_CHECKING:
    from teachpath.records import AccessToken, Capability

app: typer.Typer = typer.Typer(
    help="Tokens of programs: create, list, revoke; for auth.mode token.", no_args_is_help=True
)


@app.command("create")
def create(
    role: Annotated[list[str], typer.Option(help="What it may do; may be repeated (docs/access.md).")],
    name: Annotated[str, typer.Option(help="Of the program; the journal has it.")],
    days: Annotated[float, typer.Option(min=0.01, max=3650.0, help="Until it expires.")] = 90.0,
    keep: Annotated[
        str, typer.Option(help="URL of the station: keep the token in the file where this user's programs look for it.")
    ] = "",
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Make a token for a program, and print it this once.

    A service that runs knows it a second later.
    """
    from teachpath.access.tokens import new_token

    if not is_name(name):
        raise UnusableInput(name_refusal("token", name))
    settings = settings_of(config, data)
    token, kept = new_token(name, capabilities(role), now_ns=time.time_ns(), days=days)
    with opened_store(settings) as store:
        store.access_tokens.add(kept)
    note(settings, f"create token {name}, {' '.join(role)}, for {days:g} days")
    if keep:
        write_token(token_path(keep), token)
        said = {"file": str(token_path(keep))}
        sentence = f"token {name} is in {token_path(keep)}, where this user's programs look for it"
    else:
        said, sentence = {"token": token}, token
        print(
            f"Give it to the program as variable {TOKEN_VARIABLE}; it is kept as a hash, and never told again.",
            file=sys.stderr,
        )
    print_answer(_described(kept) | said, sentence, json_=json_)
    if settings.auth.mode == "none":
        print("The station does not ask for it yet: set auth.mode to token.", file=sys.stderr)


@app.command("list")
def list_(config: Config = None, data: Data = None, json_: Json = False) -> None:
    """List the tokens, revoked and expired ones too."""
    with opened_store(settings_of(config, data)) as store:
        known = store.access_tokens.all()
    rows = [(t.name, " ".join(t.roles), _date(t.expires_ns), _date(t.used_ns), _state(t)) for t in known]
    print_list(
        [_described(token) for token in known],
        ("name", "roles", "expires", "last used", "state"),
        rows,
        none="no tokens yet",
        json_=json_,
    )


@app.command("revoke")
def revoke(
    name: Annotated[str, typer.Argument(help="Of the token.")],
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Revoke a token; a second later a running service refuses it and ends what was opened with it."""
    settings = settings_of(config, data)
    with opened_store(settings) as store:
        store.access_tokens.revoke(name, time.time_ns())
    note(settings, f"revoke token {name}")
    print_answer({"name": name, "state": "revoked"}, f"token {name} is revoked", json_=json_)


def capabilities(roles: list[str]) -> tuple[Capability, ...]:
    """Return the capabilities that options name; raises UnusableInput."""
    from teachpath.records import Capability

    known = [each.value for each in Capability]
    for role in roles:
        if role not in known:
            raise UnusableInput(f"--role {role} is none; known: {', '.join(known)}")
    return tuple(map(Capability, roles))


def _state(token: AccessToken) -> str:
    return "revoked" if token.revoked_ns else "holds" if token.holds(time.time_ns()) else "expired"


def _described(token: AccessToken) -> dict[str, object]:
    """Return what anybody may know of a token: no hash."""
    times = {name: getattr(token, name) for name in ("expires_ns", "used_ns", "revoked_ns")}
    return {"name": token.name, "roles": list(token.roles), **times, "state": _state(token)}


def _date(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns / 1e9, UTC).strftime("%Y-%m-%d %H:%M UTC") if time_ns else "never"
