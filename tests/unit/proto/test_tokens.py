"""Where a program finds its token: a variable, or a file that nobody else may read, of that station alone."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from teachpath_proto.tokens import TOKEN_VARIABLE, find_token, token_path, write_token

URL = "http://127.0.0.1:8765"


@contextmanager
def variables(**given: str) -> Iterator[None]:
    before = {name: os.environ.pop(name, None) for name in (TOKEN_VARIABLE, "XDG_STATE_HOME")}
    os.environ.update(given)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


def test_a_token_is_found_in_its_file_and_the_variable_wins(tmp_path: Path) -> None:
    with variables(XDG_STATE_HOME=str(tmp_path)):
        assert find_token(URL) == ""
        write_token(token_path(URL), "teachpath-a")
        assert stat.S_IMODE(token_path(URL).stat().st_mode) == 0o600
        assert find_token(f"{URL}/") == "teachpath-a"
    with variables(XDG_STATE_HOME=str(tmp_path), TEACHPATH_TOKEN="teachpath-b"):
        assert find_token(URL) == "teachpath-b"


def test_another_station_is_not_told_the_token(tmp_path: Path) -> None:
    with variables(XDG_STATE_HOME=str(tmp_path)):
        write_token(token_path(URL), "teachpath-a")
        for other in ("http://127.0.0.1:8766", "https://127.0.0.1:8765", "http://127.0.0.10:8765", "http://evil:8765"):
            assert find_token(other) == ""


def test_a_file_that_others_may_read_is_refused(tmp_path: Path) -> None:
    with variables(XDG_STATE_HOME=str(tmp_path)):
        write_token(token_path(URL), "teachpath-a")
        token_path(URL).chmod(0o640)
        with pytest.raises(ValueError, match=r"others may read the token .* \(mode 0640, at most 0600\)"):
            find_token(URL)


@pytest.mark.parametrize("text", ["", "a b", "a\nb", "a\r\nX: y", "ä", "x" * 129])
def test_what_is_no_token_is_not_sent(tmp_path: Path, text: str) -> None:
    with variables(XDG_STATE_HOME=str(tmp_path)):
        write_token(token_path(URL), text)
        with pytest.raises(ValueError, match="holds no token"):
            find_token(URL)
