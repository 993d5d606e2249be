"""Logins made, listed and revoked on the command line."""

import json
import stat
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import TeachpathError
from teachpath_client.__main__ import main as client
from teachpath_proto.logins import Role, logins_path, read_logins
from tests.ports import free_endpoint


@pytest.fixture
def settings(tmp_path: Path) -> tuple[str, Path]:
    endpoint = free_endpoint()
    file = tmp_path / "station.toml"
    file.write_text(f'[bus]\nendpoint = "{endpoint}"\n')
    return endpoint, file


def said(settings: Path, *words: str) -> str:
    return CliRunner().invoke(app, ["login", *words, "--config", str(settings)], catch_exceptions=False).stdout


def test_a_login_is_made_for_another_program_and_taken_back(settings: tuple[str, Path], tmp_path: Path) -> None:
    endpoint, config = settings
    theirs = tmp_path / "theirs.json"
    assert "keep it secret" in said(
        config, "create", "lab", "--role", "tracker", "--only", "glove-2", "--into", str(theirs)
    )
    assert stat.S_IMODE(theirs.stat().st_mode) == 0o600
    (login,) = read_logins(theirs)
    assert (login.user, login.role, login.only) == ("lab", Role.TRACKER, "glove-2")
    assert login in read_logins(logins_path(endpoint))
    assert login.password not in said(config, "list")
    assert json.loads(said(config, "list", "--json")) == [{"name": "lab", "role": "tracker", "only": "glove-2"}]
    assert "revoked" in said(config, "revoke", "lab")
    assert read_logins(logins_path(endpoint)) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("create", "a..b", "--role", "viewer"), "never write"),
        (("create", "viewer", "--role", "viewer"), "already"),
        (("create", "x", "--role", "tracker", "--only", "-y"), "cannot name a tracker or robot"),
        (("revoke", "nobody"), "there is no login 'nobody'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    settings: tuple[str, Path], words: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(TeachpathError, match=sentence):
        said(settings[1], *words)


def test_the_client_names_a_file_without_a_login(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="make one with: teachpath login create"):
        client(["synthetic", "--login", str(tmp_path / "none.json")])
