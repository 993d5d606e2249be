"""The log: every line says when, how grave, which part and which request; another process's lines stand among them."""

import json
import logging
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from teachpath.logs import LogSettings, begin_request, continue_request, log_to_stderr, relay


@pytest.fixture(autouse=True)
def _clean() -> Iterator[None]:
    """Take away what a test has added to the log."""
    root = logging.getLogger()
    before, level = root.handlers[:], root.level
    yield
    forget(before)
    root.setLevel(level)
    continue_request("")


def forget(kept: list[logging.Handler]) -> None:
    root = logging.getLogger()
    for handler in [each for each in root.handlers if each not in kept]:
        root.removeHandler(handler)
        handler.close()


def lines(file: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_a_line_says_when_how_grave_which_part_and_which_request(tmp_path: Path) -> None:
    log_to_stderr(LogSettings(format="json", file=str(tmp_path / "log")))
    number = begin_request()
    logging.getLogger("teachpath.x").warning("the %s is late", "sample")
    (line,) = lines(tmp_path / "log")
    assert (line["level"], line["part"], line["request"]) == ("WARNING", "service", number)
    assert (line["logger"], line["message"]) == ("teachpath.x", "the sample is late")
    assert abs((datetime.now(UTC) - datetime.fromisoformat(line["time"])).total_seconds()) < 600


def test_a_line_of_text_has_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    log_to_stderr()
    number = begin_request()
    logging.getLogger("teachpath.x").error("no arm")
    said = capsys.readouterr().err
    assert said.endswith(f" ERROR service [{number}] teachpath.x: no arm\n")
    datetime.fromisoformat(said.split(" ", 1)[0])


def test_what_somebody_sent_begins_no_line_and_moves_no_cursor(capsys: pytest.CaptureFixture[str]) -> None:
    log_to_stderr()
    logging.getLogger("teachpath.x").info("PUT /tasks/%s: 422", "a\n2026-11-30 ERROR forged\r\x1b[2Jé\u202e")
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.endswith(r"PUT /tasks/a\n2026-11-30 ERROR forged\r\x1b[2Jé\u202e: 422" + "\n")


def test_the_lines_of_another_process_stand_among_the_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log_to_stderr(part="executor", attached=True)
    continue_request("abc")
    try:
        raise ValueError("no such arm")
    except ValueError:
        logging.getLogger("teachpath.executor").exception("it fails")
    told = capsys.readouterr().err
    forget([])

    log_to_stderr(LogSettings(format="json", file=str(tmp_path / "log")))
    said = relay(told)
    (line,) = lines(tmp_path / "log")
    assert line == json.loads(told)
    assert (line["part"], line["request"]) == ("executor", "abc")
    assert said.startswith("ERROR teachpath.executor: it fails\nTraceback")
    assert said.endswith("ValueError: no such arm")


@pytest.mark.parametrize("line", ["", "Traceback (most recent call last)", "{}", "[1]", '{"time": 1}', "7"])
def test_what_is_no_line_of_a_log_is_not_taken_for_one(line: str) -> None:
    with pytest.raises(ValueError, match="no line of a log"):
        relay(line)


def test_a_full_file_gives_way_and_few_are_kept(tmp_path: Path) -> None:
    log_to_stderr(LogSettings(file=str(tmp_path / "log"), largest_file=10_000, kept_files=2))
    for number in range(1000):
        logging.getLogger("teachpath").info("%d: a line of some length, so that files are full", number)
    kept = sorted(tmp_path.iterdir())
    assert [file.name for file in kept] == ["log", "log.1", "log.2"]
    assert all(file.stat().st_size <= 10_000 for file in kept)
    assert "999: a line" in kept[0].read_text()
