"""curve: the versions of a learned path, out to other programs (geomdl's JSON, DXF, IGES) and in from them (JSON)."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_answer, print_list
from teachpath.commands.references import find_path
from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    from teachpath.nurbs import Curve
    from teachpath_client.models import LearnedPath
    from teachpath_client.station import Station

MAX_FILE_SIZE = 1024 * 1024  # bytes of a file with one curve

FORMATS: Final = ("json", "dxf", "iges")

app: typer.Typer = typer.Typer(help="Versions of a learned path: list, export, import, compare.", no_args_is_help=True)

Path_ = Annotated[str, typer.Argument(metavar="PATH", help="TASK/CLUSTER, or an id or its beginning.")]
Number = Annotated[int | None, typer.Option(help="Its version; without it the newest on the main branch.")]


@app.command("list")
def list_(path: Path_, url: Url = "", json_: Json = False) -> None:
    """List the versions of a learned path."""
    with connected(url) as station:
        listed = station.versions(find_path(station, path))
    rows = [(v.number, v.name, v.branch, "" if v.parent is None else v.parent, v.author, v.note) for v in listed]
    print_list(listed, ("version", "name", "branch", "from", "by", "note"), rows, none="", json_=json_)


@app.command("export")
def export(
    path: Path_,
    version: Number = None,
    out: Annotated[Path | None, typer.Option(help="File to write; without it to the terminal.")] = None,
    format: Annotated[
        str, typer.Option(help="json of geomdl (NURBS-Python), dxf (SPLINE) or iges (entity 126).")
    ] = "json",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Write a version exactly, weights included: for NURBS-Python, or in metres for CAD."""
    if json_ and out is None:
        raise UnusableInput("--json says what was written to --out; without it the curve itself is printed")
    if format not in FORMATS:
        raise UnusableInput(f"there is no format {format!r} of curves; known: {', '.join(FORMATS)}")
    from teachpath.io.documents import from_document
    from teachpath.nurbs import Curve

    with connected(url) as station:
        stored = _version(station, path, version)
    text = curve_writer(format)(from_document(Curve, asdict(stored.curve)))
    if out is None:
        sys.stdout.write(text)
    else:
        out.write_text(text, encoding="utf-8")
        said = {"file": str(out), "bytes": len(text.encode()), "path": stored.id, "version": stored.version}
        print_answer(said, f"version {stored.version} of {path} written to {out}", json_=json_)


@app.command("import")
def import_(
    path: Path_,
    file: Annotated[Path, typer.Argument(help="JSON file of geomdl; its first curve is taken, in metres.")],
    base: Annotated[int | None, typer.Option(help="Version it was made from; the newest on the main branch.")] = None,
    branch: Annotated[str, typer.Option(help="To continue or to begin; that of the base.")] = "",
    name: Annotated[str, typer.Option(help="What to call the version.")] = "",
    author: Annotated[str, typer.Option(help="Who made it.")] = "",
    note: Annotated[str, typer.Option(help="Why.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Save a curve from a file as a new version; none is ever saved over another."""
    from teachpath.exchange import from_json
    from teachpath.io.documents import to_document

    curve = to_document(from_json(_text(file)))
    with connected(url) as station:
        path = find_path(station, path)
        number = base if base is not None else _version(station, path, None).version
        saved = station.save_version(path, curve, base=number, branch=branch, name=name, author=author, note=note)
    said = f"saved as version {saved.number} of {path}, on branch {saved.branch}; certify it with: teachpath plan"
    print_answer(saved, said, json_=json_)


@app.command("compare")
def compare(
    path: Path_,
    first: Annotated[int, typer.Argument(help="A version.")],
    second: Annotated[int, typer.Argument(help="Another one.")],
    url: Url = "",
    json_: Json = False,
) -> None:
    """Say how far two versions lie apart and which control points were moved."""
    with connected(url) as station:
        difference = station.difference(find_path(station, path), first, second)
    print_answer(difference, difference.sentence, json_=json_)


def curve_writer(format: str) -> Callable[[Curve], str]:
    """Return what writes a curve as text in one of `FORMATS`."""
    from teachpath.exchange import to_json
    from teachpath.io.curve_dxf import curve_dxf
    from teachpath.io.curve_iges import curve_iges

    return {"json": lambda curve: to_json(curve) + "\n", "dxf": curve_dxf, "iges": curve_iges}[format]


def _version(station: Station, path: str, number: int | None) -> LearnedPath:
    found = find_path(station, path)
    return station.get_path(found) if number is None else station.get_version(found, number).path


def _text(file: Path) -> str:
    try:
        if file.stat().st_size > MAX_FILE_SIZE:
            raise UnusableInput(f"{file} has {file.stat().st_size} bytes, limit {MAX_FILE_SIZE}; is it one curve?")
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UnusableInput(f"cannot read {file}: {error}") from None
