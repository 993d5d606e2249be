"""curve: the versions of a learned path, out to other programs and in from them, in geomdl's JSON format."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from teachpath.commands.options import LOCAL, Url
from teachpath.commands.rest import Api
from teachpath.errors import UnusableInput
from teachpath.exchange import from_json, to_json
from teachpath.nurbs import Curve

LARGEST = 1024 * 1024  # bytes of a file with one curve

app = typer.Typer(help="Versions of a learned path: list, export, import, compare.", no_args_is_help=True)

Path_ = Annotated[str, typer.Argument(metavar="PATH", help="Id of the learned path.")]
Number = Annotated[int | None, typer.Option(help="Its version; without it the newest on the main branch.")]


@app.command("versions")
def versions(path: Path_, url: Url = LOCAL) -> None:
    """List the versions of a learned path."""
    table = Table("version", "name", "branch", "from", "by", "note")
    with Api(url) as api:
        for v in api.call("GET", f"/paths/{path}/versions"):
            parent = "" if v["parent"] is None else str(v["parent"])
            table.add_row(str(v["number"]), v["name"], v["branch"], parent, v["author"], v["note"])
    Console().print(table)


@app.command("export")
def export(
    path: Path_,
    version: Number = None,
    out: Annotated[Path | None, typer.Option(help="File to write; without it to the terminal.")] = None,
    url: Url = LOCAL,
) -> None:
    """Write a version as JSON that geomdl (NURBS-Python) reads."""
    with Api(url) as api:
        stored = _version(api, path, version)
    curve = stored["curve"]
    text = to_json(Curve(curve["degree"], curve["knots"], curve["control_points"], curve["weights"]))
    if out is None:
        sys.stdout.write(text + "\n")
    else:
        out.write_text(text, encoding="utf-8")
        print(f"version {stored['version']} of {path} written to {out}")


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
    curve = from_json(_text(file))
    document = {
        "degree": curve.degree,
        "knots": curve.knots.tolist(),
        "control_points": curve.control_points.tolist(),
        "weights": curve.weights.tolist(),
    }
    words = {"branch": branch, "name": name, "author": author, "note": note}
    with Api(url) as api:
        number = base if base is not None else _version(api, path, None)["version"]
        saved = api.call("POST", f"/paths/{path}/versions", {"base": number, "curve": document, **words})
    print(f"saved as version {saved['number']} of {path}, on branch {saved['branch']}; certify it with: teachpath plan")


@app.command("compare")
def compare(
    path: Path_,
    first: Annotated[int, typer.Argument(help="A version.")],
    second: Annotated[int, typer.Argument(help="Another one.")],
    url: Url = LOCAL,
) -> None:
    """Say how far two versions lie apart and which control points were moved."""
    with Api(url) as api:
        print(api.call("GET", f"/paths/{path}/versions/{first}/difference/{second}")["sentence"])


def _version(api: Api, path: str, number: int | None) -> dict[str, Any]:
    found: dict[str, Any] = (
        api.call("GET", f"/paths/{path}")
        if number is None
        else api.call("GET", f"/paths/{path}/versions/{number}")["path"]
    )
    return found


def _text(file: Path) -> str:
    try:
        if file.stat().st_size > LARGEST:
            raise UnusableInput(f"{file} has {file.stat().st_size} bytes, limit {LARGEST}; is it one curve?")
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UnusableInput(f"cannot read {file}: {error}") from None
