"""The tokens of programs on the command line."""

import json
import re
import stat
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.tokens import digest_of
from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Capability
from teachpath_proto.tokens import TOKEN_VARIABLE


def said(data: Path, *words: str) -> str:
    environment = {"XDG_STATE_HOME": str(data / "state"), "COLUMNS": "200", TOKEN_VARIABLE: None}
    return (
        CliRunner().invoke(app, ["token", *words, "--data", str(data)], env=environment, catch_exceptions=False).stdout
    )


def test_a_token_is_made_listed_and_revoked(tmp_path: Path) -> None:
    roles = ("--role", "operate", "--role", "teach")
    token = said(tmp_path, "create", *roles, "--name", "cell-3", "--days", "90").strip()
    assert re.fullmatch(r"teachpath-[\w-]{43}", token)
    store = Store(StoreSettings(data_dir=str(tmp_path)))
    (kept,) = store.access_tokens.all()
    store.close()
    assert (kept.name, kept.roles, kept.digest) == ("cell-3", (Capability.OPERATE, Capability.TEACH), digest_of(token))
    assert kept.expires_ns - kept.created_ns == 90 * 86_400 * 10**9
    listed = said(tmp_path, "list")
    assert re.search(r"cell-3.*operate teach.*never.*holds", listed)
    assert token not in listed
    (described,) = json.loads(told := said(tmp_path, "list", "--json"))
    assert (described["name"], described["state"], described["roles"]) == ("cell-3", "holds", ["operate", "teach"])
    assert token not in told
    assert kept.digest not in told
    with pytest.raises(Conflict, match="revoke it first"):
        said(tmp_path, "create", *roles, "--name", "cell-3")
    assert said(tmp_path, "revoke", "cell-3") == "token cell-3 is revoked\n"
    assert "revoked" in said(tmp_path, "list")
    with pytest.raises(NotFound):
        said(tmp_path, "revoke", "cell-3")


def test_a_token_is_kept_where_programs_look_for_it_and_not_shown(tmp_path: Path) -> None:
    words = ("create", "--role", "view", "--name", "screen", "--keep", "http://127.0.0.1:8765")
    assert "teachpath-" not in said(tmp_path, *words).replace("teachpath-data", "")
    (file,) = (tmp_path / "state").rglob("*.token")
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert file.read_text().startswith("teachpath-")


def test_a_name_that_could_be_taken_for_another_is_refused(tmp_path: Path) -> None:
    for name in ("not signed in", "a (b)", "", "ü"):
        with pytest.raises(UnusableInput, match="cannot name a token"):
            said(tmp_path, "create", "--role", "view", "--name", name)
