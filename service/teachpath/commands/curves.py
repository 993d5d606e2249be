"""curve: the versions of a learned path, out to other programs and in from them, in geomdl's JSON format."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from teachpath.commands.options import LOCAL, Url
from teachpath.errors import UnusableInput
from teachpath.exchange import from_json, to_json
from teachpath.io.documents import from_document, to_document
from teachpath.nurbs import Curve
from teachpath_client.models import LearnedPath
from teachpath_client.station import Station

MAX_FILE_SIZE = 1024 * 1024  # bytes of a file with one curve

app = typer.Typer(help="Versions of a learned path: list, export, import, compare.", no_args_is_help=True)

Path_ = Annotated[str, typer.Argument(metavar="PATH", help="Id of the learned path.")]
Number = Annotated[int | None, typer.Option(help="Its version; without it the newest on the main branch.")]


@app.command("versions")
def versions(path: Path_, url: Url = LOCAL) -> None:
    """List the versions of a learned path."""
    table = Table("version", "name", "branch", "from", "by", "note")
    with Station(url) as station:
        for v in station.versions(path):
            parent = "" if v.parent is None else str(v.parent)
            table.add_row(str(v.number), v.name, v.branch, parent, v.author, v.note)
    Console().print(table)


@app.command("export")
def export(
    path: Path_,
    version: Number = None,
    out: Annotated[Path | None, typer.Option(help="File to write; without it to the terminal.")] = None,
    url: Url = LOCAL,
) -> None:
    """Write a version as JSON that geomdl (NURBS-Python) reads."""
    with Station(url) as station:
        stored = _version(station, path, version)
    text = to_json(from_document(Curve, asdict(stored.curve)))
    if out is None:
        sys.stdout.write(text + "\n")
    else:
        out.write_text(text, encoding="utf-8")
        print(f"version {stored.version} of {path} written to {out}")


@app.command("import")
def import_(
    path: Path_,
    file: Annotated[Path, typer.Argument(help="JSON file of geomdl; its first curve is taken, in metres.")],
    base: Annotated[int | None, typer.Option(help="Version it was made from; the newest on the main branch.")] = None,
    branch: Annotated[str, typer.Option(help="To continue or to begin; that of the base.")] = "",
    name: Annotated[str, typer.Option(help="What to call the version.")] = "",
    author: Annotated[str, typer.Option(help="Who made it.")] = "",
    note: Annotated[str, typer.Option(help="Why.")] = "",
    url: Url = LOCAL,
) -> None:
    """Save a curve from a file as a new version; none is ever saved over another."""
    curve = to_document(from_json(_text(file)))
    with Station(url) as station:
        number = base if base is not None else _version(station, path, None).version
        saved = station.save_version(path, curve, base=number, branch=branch, name=name, author=author, note=note)
    print(f"saved as version {saved.number} of {path}, on branch {saved.branch}; certify it with: teachpath plan")


@app.command("compare")
def compare(
    path: Path_,
    first: Annotated[int, typer.Argument(help="A version.")],
    second: Annotated[int, typer.Argument(help="Another one.")],
    url: Url = LOCAL,
) -> None:
    """Say how far two versions lie apart and which control points were moved."""
    with Station(url) as station:
        print(station.difference(path, first, second).sentence)


def _version(station: Station, path: str, number: int | None) -> LearnedPath:
    return station.get_path(path) if number is None else station.get_version(path, number).path


def _text(file: Path) -> str:
    try:
        if file.stat().st_size > MAX_FILE_SIZE:
            raise UnusableInput(f"{file} has {file.stat().st_size} bytes, limit {MAX_FILE_SIZE}; is it one curve?")
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UnusableInput(f"cannot read {file}: {error}") from None
