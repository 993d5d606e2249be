"""--json: every command that answers has it, and what it prints is what was done."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.core import TyperGroup
from typer.main import get_command
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.tokens import digest_of
from teachpath.errors import UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath_proto.tokens import TOKEN_VARIABLE
from tests.ports import free_endpoint

# They run until they are ended, or what they print is a file in a form of its own.
NO_ANSWER = {"serve", "worker", "replay", "executor", "simulator", "station router", "audit export"}


@pytest.fixture
def data(tmp_path: Path) -> Path:
    folder = tmp_path / "data"
    folder.mkdir()
    (tmp_path / "station.toml").write_text(
        f'[bus]\nendpoint = "{free_endpoint()}"\ncertificates = "{tmp_path}/bus"\n[store]\ndata_dir = "{folder}"\n'
    )
    return folder


def told(data: Path, *words: str, typed: str = "") -> Any:
    environment = {"XDG_STATE_HOME": str(data.parent / "state"), TOKEN_VARIABLE: None}
    line = [*words, "--json"]
    answer = CliRunner().invoke(app, line, env=environment, input=typed, catch_exceptions=False)
    assert answer.exit_code == 0, answer.output
    return json.loads(answer.stdout)


def test_every_command_that_answers_has_it() -> None:
    def lacking(group: TyperGroup, *path: str) -> set[str]:
        found = set()
        for name, command in group.commands.items():
            if isinstance(command, TyperGroup):
                found |= lacking(command, *path, name)
            elif not any("--json" in option.opts for option in command.params):
                found.add(" ".join((*path, name)))
        return found

    root = get_command(app)
    assert isinstance(root, TyperGroup)
    assert lacking(root) == NO_ANSWER


def test_tokens_and_people_are_said_without_their_hashes(data: Path) -> None:
    at = ("--data", str(data))
    made = told(data, "token", "create", "--role", "view", "--name", "wall", *at)
    store = Store(StoreSettings(data_dir=str(data)))
    (kept,) = store.access_tokens.all()
    store.close()
    assert digest_of(made["token"]) == kept.digest
    assert (made["name"], made["roles"], made["expires_ns"]) == ("wall", ["view"], kept.expires_ns)
    assert told(data, "token", "revoke", "wall", *at) == {"name": "wall", "state": "revoked"}
    added = told(data, "person", "add", "ada", "--role", "teach", *at, typed="a long one of several words\n")
    assert added == told(data, "person", "list", *at)[0]
    assert told(data, "person", "remove", "ada", *at) == {"name": "ada", "removed": True}
    assert told(data, "audit", "verify", *at)["entries"] == 4


def test_logins_and_certificates_are_said(data: Path) -> None:
    settings = ("--config", str(data.parent / "station.toml"))
    theirs = data.parent / "theirs.json"
    made = told(data, "login", "create", "lab", "--role", "tracker", "--into", str(theirs), *settings)
    assert made == {"name": "lab", "role": "tracker", "only": "", "file": str(theirs)}
    assert theirs.is_file()
    assert told(data, "login", "revoke", "lab", *settings) == {"name": "lab", "revoked": True}
    first, second = (told(data, "station", "certificates", *settings) for _ in range(2))
    assert (first["authority_made"], second["authority_made"]) == (True, False)
    assert {each["state"] for each in first["certificates"]} == {"made"}
    assert second["certificates"] == [each | {"state": "as before"} for each in first["certificates"]]
    web = told(data, "tls", "init", "--name", "cell.lab", *settings)
    assert Path(web["authority"]).is_file()
    assert "cell.lab" in web["hosts"]
    assert "cell.lab" in web["missing_hosts"]


def test_arms_and_copies_are_said(data: Path) -> None:
    at = ("--data", str(data))
    added = told(data, "arm", "add", "six", "six-axis", *at)
    assert [added] == told(data, "arm", "list", *at)
    checked = told(data, "arm", "check", "six", *at)
    assert checked["arm"] == added["arm"]
    assert any("neighbours" in note for note in checked["notes"])
    copied = told(data, "store", "copy", str(data), str(data.parent / "copy"))
    assert copied["rows"] == sum(copied["tables"].values()) > 0


def test_a_curve_on_the_terminal_is_no_answer(data: Path) -> None:
    with pytest.raises(UnusableInput, match="--json says what was written to --out"):
        told(data, "curve", "export", "path-1")
