"""Writes the reference pages from what the code says of itself: commands, settings, REST, errors, Python."""

from __future__ import annotations

import inspect
import json
import os
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any, Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT: Final = Path(__file__).parents[2]
TERMINAL: Final = {"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
OPENAPI: Final = ROOT / "tests" / "contract" / "openapi.json"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages; the navigation names them."""
    pages = {"commands": _commands, "settings": _settings, "rest": _rest, "errors": _errors, "python": _python}
    for name, lines in pages.items():
        files.append(File.generated(config, f"reference/{name}.md", content="\n".join(lines())))
    icon = (ROOT / "clients" / "web" / "icon.svg").read_bytes()
    files.append(File.generated(config, "icon.svg", content=icon))
    return files


def _commands() -> Iterator[str]:
    import typer.main

    from teachpath.__main__ import app

    yield "# Commands\n"
    yield "`teachpath` works at a station, `teachpath-client` beside a tracker or a driver, also on a small computer.\n"
    yield from _help("teachpath", [])
    yield from _typer_commands(typer.main.get_command(app), [])
    yield from _help("teachpath-client", [])
    from teachpath_client.__main__ import parser_of_commands

    parser = parser_of_commands()
    actions = parser._subparsers._group_actions if parser._subparsers else []  # argparse has no other way to them
    for name in actions[0].choices or {}:
        yield from _help("teachpath-client", [str(name)])


def _typer_commands(group: Any, words: list[str]) -> Iterator[str]:
    for name, command in sorted(group.commands.items()):
        if command.hidden:
            continue
        if hasattr(command, "commands"):
            yield from _typer_commands(command, [*words, name])
        else:
            yield from _help("teachpath", [*words, name])


def _help(program: str, words: list[str]) -> Iterator[str]:
    """Yield a section with what a command says of itself; its terminal has a width of its own."""
    from contextlib import redirect_stdout
    from io import StringIO

    said = StringIO()
    before = dict(os.environ)
    os.environ.update(TERMINAL)
    try:
        with redirect_stdout(said):
            if program == "teachpath":
                from teachpath.__main__ import app

                app([*words, "--help"], prog_name=program, standalone_mode=False)
            else:
                from teachpath_client.__main__ import parser_of_commands

                parser_of_commands().parse_args([*words, "--help"])
    except SystemExit:  # argparse ends so
        pass
    finally:
        os.environ.clear()
        os.environ.update(before)
    yield f"## {' '.join([program, *words])}\n\n```text\n{said.getvalue().strip()}\n```\n"


def _settings() -> Iterator[str]:
    yield "# Settings\n"
    yield "Every setting with its meaning, its limits and its default, as in `deploy/teachpath.toml`.\n"
    yield f"```toml\n{(ROOT / 'deploy' / 'teachpath.toml').read_text().strip()}\n```"


def _rest() -> Iterator[str]:
    document = json.loads(OPENAPI.read_text())
    yield "# REST\n"
    yield (
        "All resources lie below `/api/v1` of a station, which shows them with every field, and lets one try them, "
        "under `/docs`; `/openapi.json` is the document for generators. Who may do what: [capabilities]"
        "(../access.md). In Python, `teachpath_client.Station` has a [method](python.md) for each.\n"
    )
    by_tag: dict[str, list[str]] = {}
    for place, operations in document["paths"].items():
        for method, operation in operations.items():
            tag = (operation.get("tags") or ["other"])[0]
            row = f"| `{method.upper()}` | `{place.removeprefix('/api/v1')}` | {operation['summary']} |"
            by_tag.setdefault(tag, []).append(row)
    for tag, rows in by_tag.items():
        yield f"## {tag.capitalize()}\n\n| | resource | |\n|---|---|---|"
        yield from rows
        yield ""


def _errors() -> Iterator[str]:
    from teachpath import errors
    from teachpath.api.faults import status_of

    yield "# Errors\n"
    yield (
        "Every refusal is a sentence that names the value, the limit, the place and the way out. In Python it is an "
        "exception with this name; over REST its name stands in `error` beside the sentence in `detail`; a command "
        "prints the sentence and ends with status 1.\n"
    )
    yield "| error | is a | REST | when |\n|---|---|---|---|"
    for name, kind in vars(errors).items():
        if inspect.isclass(kind) and issubclass(kind, errors.TeachpathError) and kind.__module__ == errors.__name__:
            status = status_of(kind.__new__(kind))
            meaning = inspect.cleandoc(kind.__doc__ or "").split("\n")[0]
            yield f"| `{name}` | {kind.__bases__[0].__name__} | {status} {HTTPStatus(status).phrase} | {meaning} |"


def _python() -> Iterator[str]:
    import teachpath
    import teachpath_client

    yield "# Python\n"
    yield (
        "`import teachpath` works without a service: arrays in, a certified plan out. `import teachpath_client` is the "
        "client of a running station; it is all that a small computer beside a tracker needs.\n"
    )
    for package in (teachpath, teachpath_client):
        yield f"## {package.__name__}\n"
        for name in package.__all__:
            value = getattr(package, name)
            if not (inspect.isclass(value) and issubclass(value, teachpath.TeachpathError)):
                yield f"::: {value.__module__}.{value.__qualname__}\n"
    yield "## teachpath_client.driver\n\n::: teachpath_client.driver\n    options: {show_root_heading: false}\n"
