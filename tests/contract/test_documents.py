"""What the documents say is there: the files that they link to, and the commands with their options."""

import re
import shlex
import tomllib
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
import typer.main

from teachpath.__main__ import app
from teachpath.config import Settings, load
from teachpath_client.__main__ import parser_of_commands

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted(
    path
    for pattern in ("*.md", "docs/*.md", "proto/*.md", "clients/*/*.md", "tests/**/*.md")
    for path in ROOT.glob(pattern)
)
PROGRAMS = ("teachpath", "teachpath-client")
LINK = re.compile(r"\]\(([^)\s]+)\)")
SHELL = re.compile(r"```sh\n(.*?)```", re.DOTALL)
TOML = re.compile(r"```toml\n(.*?)```", re.DOTALL)
INLINE = re.compile(r"`(teachpath [^`]+)`")


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def anchors(document: Path) -> set[str]:
    """Names by which headings of a document are linked to."""
    headings = re.findall(r"^#+ (.*)$", document.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def commands(document: Path) -> Iterator[list[str]]:
    """Words of every command of ours in a document."""
    text = document.read_text()
    for block in (*SHELL.findall(text), *INLINE.findall(text)):
        for line in block.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            for place, word in enumerate(words[:3]):  # variables may stand before it
                if word.removeprefix(".venv/bin/") in PROGRAMS:
                    yield [word.removeprefix(".venv/bin/"), *words[place + 1 :]]
                    break


def settings(document: Path) -> list[dict[str, Any]]:
    """Settings of a station that a document shows, block by block."""
    blocks = [tomllib.loads(block) for block in TOML.findall(document.read_text())]
    return [block for block in blocks if block.keys() <= Settings.model_fields.keys()]


@pytest.mark.parametrize("document", [d for d in DOCUMENTS if settings(d)], ids=name_of)
def test_settings_in_the_documents_are_a_station_s(document: Path) -> None:
    for block in settings(document):
        load(document=block)


@pytest.mark.parametrize("document", DOCUMENTS, ids=name_of)
def test_what_is_linked_to_is_there(document: Path) -> None:
    for target in LINK.findall(document.read_text()):
        if re.match(r"[a-z]+:", target):
            continue  # on another machine
        place, _, anchor = target.partition("#")
        file = (document.parent / place).resolve() if place else document
        if file.parent == ROOT / "docs" / "reference":  # written when the site is built, which checks its anchors
            assert f": reference/{file.name}" in (ROOT / "mkdocs.yml").read_text(), target
            continue
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


@pytest.mark.parametrize(
    "document", [d for d in DOCUMENTS if d.name != "CHANGELOG.md" and any(commands(d))], ids=name_of
)
def test_commands_in_the_documents_exist_with_their_options(document: Path) -> None:
    for program, *words in commands(document):
        if program == "teachpath-client":
            with pytest.raises(SystemExit, match=r"^0$") if "--help" in words else nullcontext():
                parser_of_commands().parse_args(words)
            continue
        command: Any = typer.main.get_command(app)
        options = list(command.params)
        while words and hasattr(command, "commands") and words not in (["--help"], ["COMMAND"]):
            if words[0].startswith("-"):
                (option,) = (one for one in options if words[0] in one.opts)
                words = words[1 if option.is_flag else 2 :]
                continue
            assert words[0] in command.commands, words
            command = command.commands[words.pop(0)]
            options += command.params
        known = {name for one in options for name in (*one.opts, *one.secondary_opts)} | {"--help"}
        given = {word.partition("=")[0] for word in words if re.match(r"-{1,2}[a-z]", word)}
        assert given <= known, (command.name, given - known)


def test_the_command_line_is_shown() -> None:
    assert len(list(commands(ROOT / "docs" / "command-line.md"))) > 20
