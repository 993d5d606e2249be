"""One language: identifiers are the field's standard terms, and words that only insiders knew do not come back."""

from pathlib import Path

import pytest

from tests.contract.identifiers import constants, declared, python_identifiers, script_identifiers, words

ROOT = Path(__file__).parents[2]
LEFT_OUT = ("vendor", "node_modules", "migrations", "_pb2")

# Words of no identifier, each with the field's term. Where a word also has a plain meaning, such as `sign` of a number,
# only the names below are barred.
FORMER_WORDS = {
    "account": "statistics", "accounts": "statistics",
    "afterglow": "grace period",
    "admit": "accept, register",
    "apart": "separation",
    "coach": "guidance",
    "courier": "sample sender",
    "crowd": "subsample",
    "curation": "annotations",
    "deaf": "stall",
    "departure": "deviation", "departures": "deviations",
    "describing": "summary",
    "desk": "worker",
    "dismiss": "disconnect",
    "easel": "overlay",
    "enough": "the least gain or clearance, with its unit",
    "fastest": "rate limit",
    "feeling": "haptic feedback",
    "gallery": "scene layers",
    "gate": "trackers over WebSocket", "gated": "trackers over WebSocket",
    "grab": "grasp",
    "hearing": "joint state monitor",
    "intake": "sample queues",
    "judgement": "check, assessment",
    "leaps": "level shifts",
    "levers": "lever arms",
    "lookout": "state poller",
    "merging": "average linkage",
    "mirror": "follow, teleoperate",
    "misnamed": "invalid names",
    "news": "event hub",
    "onlooker": "subscriber",
    "orienting": "orientation fit",
    "patience": "timeout",
    "presser": "remote clutch",
    "prospects": "path summaries",
    "rehearsal": "motion preview",
    "remedy": "suggestion",
    "reserve": "margins",
    "screening": "input validation",
    "scribe": "recording thread",
    "sketch": "curve overlay",
    "stage": "environment",
    "standoff": "approach, retreat",
    "stepping": "jog",
    "strength": "torque limits",
    "stretches": "segments",
    "sweep": "continuous collision check",
    "tally": "message counter",
    "think": "plan",
    "told": "status, reported",
    "twin": "protocol simulator, copy", "twins": "protocol simulators",
    "uptake": "stall detector",
}  # fmt: skip
FORMER_NAMES = {
    "Hand", "Look", "LOOKS", "Line", "MOST", "WAYS", "ONE", "Standing", "Finished", "Stretch", "MIRROR", "sign",
    "jumps", "here", "doing", "standing", "aside", "begun", "Piece", "Listener", "Post", "Prop",
}  # fmt: skip
# Adverbs, pronouns, adjectives and participles, which alone do not say what a constant is.
BARE_WORDS = frozenset((Path(__file__).parent / "bare_words.txt").read_text(encoding="utf-8").split())
PLAIN_USES = {
    # file: names that have their plain meaning there
    "service/teachpath/motion/paths/ik_branches.py": {"jumps"},  # of a joint between two nodes
}


def source_files(*suffixes: str) -> list[Path]:
    found = [
        file for room in ("service", "clients", "proto") for s in suffixes for file in (ROOT / room).rglob(f"*{s}")
    ]
    return [file for file in found if not any(part in file.as_posix() for part in LEFT_OUT)]


def test_no_identifier_has_a_word_that_needs_a_glossary() -> None:
    files = source_files(".py", ".js")
    assert len(files) > 300
    found = [
        f"{place}: {identifier} (say {FORMER_WORDS[word]})"
        for identifier, place in declared(ROOT, files)
        for word in words(identifier)
        if word in FORMER_WORDS
    ]
    assert found == []


def test_no_identifier_is_called_as_it_was() -> None:
    found = [
        f"{place}: {identifier}"
        for identifier, place in declared(ROOT, source_files(".py"))
        if identifier.strip("_") in FORMER_NAMES and identifier.strip("_") not in PLAIN_USES.get(place, ())
    ]
    assert found == []


def test_no_constant_is_called_by_a_bare_word() -> None:
    files = [
        *source_files(".py", ".js"),
        *(file for room in ("tests", "tools") for file in (ROOT / room).rglob("*.py")),
        *(ROOT / "tests" / "page").glob("*.js"),
    ]
    files = [file for file in files if "node_modules" not in file.parts]
    named = [
        (file.relative_to(ROOT).as_posix(), constant)
        for file in files
        for constant in constants(file.read_text(encoding="utf-8"), script=file.suffix == ".js")
    ]
    assert len(named) > 1000
    assert [f"{place}: {constant}" for place, constant in named if constant.strip("_").lower() in BARE_WORDS] == []


@pytest.mark.parametrize(
    ("source", "script"),
    [
        ("AGAIN = 1", False),
        ("from typing import Final\n\nFIRST: Final = 1", False),
        ("A, _LEFT = 1, 2", False),
        ("export const AWAY = 1;", True),
    ],
)
def test_every_kind_of_constant_is_read(source: str, script: bool) -> None:
    assert any(name.strip("_").lower() in BARE_WORDS for name in constants(source, script=script))


def test_the_messages_on_the_bus_have_no_such_word() -> None:
    found = [
        f"{file.name}: {word}"
        for file in source_files(".proto")
        for line in file.read_text(encoding="utf-8").splitlines()
        for identifier in line.partition("//")[0].replace("=", " ").split()
        for word in words(identifier)
        if word in FORMER_WORDS
    ]
    assert found == []


@pytest.mark.parametrize(
    "source",
    [
        "class TrackerGate: pass",
        "def admit(tracker): pass",
        "PATIENCE = 3.0",
        "class A:\n    departure: float = 0.0",
        "class A:\n    def __init__(self):\n        self._twins = ()",
        "A, (SWEEP, B) = 1, (2, 3)",
    ],
)
def test_every_kind_of_identifier_of_a_module_is_read(source: str) -> None:
    assert any(word in FORMER_WORDS for name in python_identifiers(source) for word in words(name))


@pytest.mark.parametrize(
    "source",
    [
        "export function openGate() {",
        "const SKETCH_COLOR = 1;",
        "class A {\n  #easel = null;",
        "class A {\n  twins() {\n",
    ],
)
def test_every_kind_of_identifier_of_the_page_is_read(source: str) -> None:
    assert any(word in FORMER_WORDS for name in script_identifiers(source) for word in words(name))


def test_local_variables_may_be_called_as_the_author_likes() -> None:
    assert list(python_identifiers("def f():\n    enough = 3\n    return enough")) == ["f"]


def test_the_object_and_an_obstacle_are_never_both_the_box() -> None:
    page = [p for p in (ROOT / "clients" / "web").rglob("*.js") if "vendor" not in p.parts]
    documents = [
        ROOT / "README.md",
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "service" / "teachpath" / "commands").glob("*.py"),
    ]
    assert page
    for file in page + documents:
        assert "the box" not in file.read_text().lower(), (
            f"{file}: say the object (block in scene paper), or the obstacle"
        )
