"""People on the command line."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.passwords import is_password
from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store


def said(data: Path, *words: str, password: str = "") -> str:
    command = ["person", *words, "--data", str(data)]
    return CliRunner().invoke(app, command, input=f"{password}\n", catch_exceptions=False).stdout


def kept(data: Path) -> str:
    store = Store(StoreSettings(data_dir=str(data)))
    (person,) = store.people.all()
    store.close()
    return person.password_hash


def test_a_person_is_added_listed_and_removed(tmp_path: Path) -> None:
    roles = ("--role", "teach", "--role", "operate")
    assert said(tmp_path, "add", "anna", *roles, password="four words of mine") == "anna may teach, operate\n"
    assert is_password("four words of mine", kept(tmp_path))
    with pytest.raises(Conflict, match="is taken"):
        said(tmp_path, "add", "anna", *roles, password="four words of mine")
    assert "teach operate" in said(tmp_path, "list")
    (described,) = json.loads(told := said(tmp_path, "list", "--json"))
    assert (described["name"], described["roles"], described["sessions"]) == ("anna", ["teach", "operate"], 0)
    assert "argon2" not in told
    said(tmp_path, "password", "anna", password="other words of mine")
    assert is_password("other words of mine", kept(tmp_path))
    assert said(tmp_path, "remove", "anna") == "anna is removed\n"
    assert "anna" not in said(tmp_path, "list")
    with pytest.raises(NotFound, match="no person 'anna'"):
        said(tmp_path, "remove", "anna")


@pytest.mark.parametrize(("name", "password"), [("a b", "four words of mine"), ("anna", "short"), ("anna", "")])
def test_what_cannot_be_used_is_refused(tmp_path: Path, name: str, password: str) -> None:
    with pytest.raises(UnusableInput):
        said(tmp_path, "add", name, "--role", "view", password=password)
