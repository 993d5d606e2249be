"""The file of the signing key: made once, for its owner alone."""

import os
import stat
from pathlib import Path

import pytest

from teachpath.errors import UnusableSettings
from teachpath.io.signing_key import prepare_signing_key, read_signing_key, signing_key_path

posix = pytest.mark.skipif(os.name == "nt", reason="file modes say nothing there")


@pytest.fixture
def endpoint(tmp_path: Path) -> str:
    """An endpoint that no other test has: its state folder is that of all tests."""
    return f"tcp/{tmp_path.name}:1"


@posix
def test_it_is_made_at_the_first_start_for_its_owner_alone_and_kept(endpoint: str) -> None:
    key = prepare_signing_key(endpoint)
    assert len(key) == 32
    assert stat.S_IMODE(signing_key_path(endpoint).stat().st_mode) == 0o600
    assert prepare_signing_key(endpoint) == read_signing_key(endpoint) == key
    assert prepare_signing_key(f"{endpoint}2") != key
    assert [f for f in signing_key_path(endpoint).parent.iterdir() if f.name.startswith("tmp")] == []


@posix
@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o610])
def test_one_that_others_may_use_is_refused_and_left_as_it_is(endpoint: str, mode: int) -> None:
    key = prepare_signing_key(endpoint)
    path = signing_key_path(endpoint)
    path.chmod(mode)
    with pytest.raises(UnusableSettings, match=rf"mode {mode:04o}, at most 0600.*remove it.*chmod 600") as refused:
        prepare_signing_key(endpoint)
    assert key.hex() not in str(refused.value)
    path.chmod(0o600)
    assert read_signing_key(endpoint) == key


@pytest.mark.parametrize("content", [b"", b"00" * 31, b"00" * 33, b"xy" * 32, b"\xff" * 64])
def test_what_is_no_key_is_refused(endpoint: str, content: bytes) -> None:
    prepare_signing_key(endpoint)
    signing_key_path(endpoint).write_bytes(content)
    with pytest.raises(UnusableSettings, match=r"is no signing key of 32 bytes.*remove it"):
        prepare_signing_key(endpoint)


def test_an_executor_alone_does_not_make_one(endpoint: str) -> None:
    with pytest.raises(UnusableSettings, match=r"there is no signing key .*teachpath serve"):
        read_signing_key(endpoint)
    assert not signing_key_path(endpoint).exists()
