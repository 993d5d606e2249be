"""The generated messages are those of the .proto files, which say what every field of theirs is."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import get_args

import pytest

from teachpath.records import JobState, Phase, Verdict
from teachpath.records.recording import FistCommand, RecordingState
from teachpath.records.work import JobKindName
from teachpath_proto.control import ExecutorState
from tests.contract import messages

DECLARATION = re.compile(r"^(?:(message|enum) (\w+) \{|((?:optional |repeated )?[\w.]+ )?(\w+) = (\d+);)$")
UNIT = re.compile(r"\[(1|m|s|ns|us|Hz|rad|rad/s|rad/s\^2|N m)\b[^\]]*\]|unit of the field")


def unsaid(text: str) -> Iterator[str]:
    """Yield what a .proto file leaves unsaid: comments before declarations, units, and numbers that are gone."""
    comment, scope = "", [("file", set[int]())]
    for line in map(str.strip, text.splitlines()):
        if line.startswith("//"):
            comment += line
            continue
        if line == "}":
            owner, numbers = scope.pop()
            gone = set(range(min(numbers), max(numbers))) - numbers
            yield from (f"{owner} does not reserve {number}" for number in sorted(gone))
        if line.startswith("reserved"):
            scope[-1][1].update(map(int, re.findall(r"\d+", line)))
        if found := DECLARATION.match(line):
            _, owner, kind, field, number = found.groups()
            name = owner or f"{scope[-1][0]}.{field}"
            if not comment:
                yield f"{name} has no comment before it"
            elif (kind and re.search(r"double|float", kind)) or (field and field.endswith(("_ns", "_us"))):
                yield from [] if UNIT.search(comment) else [f"{name} has no unit"]
            scope.append((owner, set())) if owner else scope[-1][1].add(int(number))
        comment = ""


@pytest.mark.parametrize("file", messages.FILES, ids=lambda file: str(file.name))
def test_every_field_says_what_it_is_and_in_which_unit(file: Path) -> None:
    assert list(unsaid(file.read_text())) == []


@pytest.mark.parametrize(
    ("file", "field", "words"),
    [
        ("job", "JobProgress.kind", get_args(JobKindName)),
        ("job", "JobProgress.state", JobState),
        ("motion", "ExecutorStatus.state", set(ExecutorState) - {ExecutorState.STARTING}),  # which the service says
        ("tracker", "RecordingReport.phase", Phase),
        ("tracker", "RecordingReport.state", RecordingState),
        ("tracker", "RecordingReport.pending_command", FistCommand),
        ("tracker", "DemonstrationReport.verdict", Verdict),
    ],
)
def test_the_words_of_a_field_are_those_of_the_program(file: str, field: str, words: Iterable[str]) -> None:
    message, _, name = field.partition(".")
    text = (messages.PACKAGE / messages.SOURCES / f"{file}.proto").read_text()
    body = text.partition(f"message {message} {{")[2].partition("\n}")[0]
    comment = re.search(rf"// (.*)\n *string {name} =", body)
    assert comment is not None
    said = re.findall("[a-z]+", comment[1].partition(";")[0].rpartition(":")[2])
    assert set(said) - {"or", "nothing"} == set(words)


def test_what_a_proto_file_leaves_unsaid_is_found() -> None:
    text = (
        "// of a hand\nmessage A {\n  // how long\n  double a = 1;\n  string b = 3;\n}\nenum B {\n  // no\n  C = 0;\n}"
    )
    assert list(unsaid(text)) == [
        "A.a has no unit",
        "A.b has no comment before it",
        "A does not reserve 2",
        "B has no comment before it",
    ]


def test_generated_messages_are_up_to_date(tmp_path: Path) -> None:
    messages.generate(tmp_path)
    fresh = {file.name: file.read_text() for file in tmp_path.iterdir()}
    kept = {file.name: file.read_text() for file in messages.PACKAGE.glob("*_pb2.py*")}
    assert len(fresh) == 2 * len(messages.FILES)
    assert fresh == kept, "run: make proto"
