"""scene: what stands around the arm, from files and by name; every version is kept."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import moment, print_answer, print_columns, print_json, print_list
from teachpath.commands.references import id_or_words
from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    from teachpath_client.models import SceneVersion
    from teachpath_client.station import Station

app: typer.Typer = typer.Typer(
    help="Scenes of a running station: add, show, versions, copy, remove, restore (docs/scenes.md); "
    "teachpath scenes lists them.",
    no_args_is_help=True,
)

Name = Annotated[str, typer.Argument(help="The scene, by name or as people call it.", callback=id_or_words)]
Note = Annotated[str, typer.Option(help="Why, for whoever reads the versions.")]
Number = Annotated[int | None, typer.Option("--version", help="Its number; the newest unless given.")]


@app.command("add")
def add(
    file: Annotated[Path, typer.Argument(help="TOML or JSON: one scene, or `scenes` as in the settings.")],
    name: Annotated[str, typer.Option(help="Of the scene, instead of the one in the file.")] = "",
    note: Note = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Make the scenes of a file, or change those of these names; meshes are read beside the file."""
    read = _scenes(file)
    if name and len(read) > 1:
        raise UnusableInput(f"{file} has {len(read)} scenes; name is for a file with one")
    with connected(url) as station:
        saved = [_save(station, name or scene["name"], _without_name(scene), note) for scene in read]
    print_answer(saved, *(f"scene {each.scene}, version {each.number}" for each in saved), json_=json_)


def _save(station: Station, name: str, scene: dict[str, Any], note: str) -> SceneVersion:
    """Save a scene under a name of any letters."""
    made = id_or_words(name)
    return station.save_scene(made, ({"display_name": name} if made != name else {}) | scene, note=note)


@app.command("show")
def show(name: Name, version: Number = None, url: Url = "", json_: Json = False) -> None:
    """Show what stands in a scene as it was saved; with --json as `scene add` takes it."""
    with connected(url) as station:
        saved = station.get_scene(name, version)
    if json_:
        print_json(saved.scene)
        return
    said = saved.version
    print(f"scene {name}, version {said.number}" + "".join(f", {word}" for word in (said.author, said.note) if word))
    print_bodies(asdict(saved.scene))


@app.command("versions")
def versions(name: Name, url: Url = "", json_: Json = False) -> None:
    """List the versions of a scene, newest first, of one that was removed too."""
    with connected(url) as station:
        listed = station.scene_versions(name)
    rows = [(each.number, moment(each.created_ns), each.author, "removed" * each.removed, each.note) for each in listed]
    print_list(listed, ("version", "saved", "by", "", "note"), rows, none="", json_=json_)


@app.command("copy")
def copy(
    name: Name,
    to: Annotated[str, typer.Argument(help="Name of the copy.")],
    url: Url = "",
    json_: Json = False,
) -> None:
    """Keep a scene under another name too."""
    with connected(url) as station:
        made = station.copy_scene(name, id_or_words(to), display_name=to if id_or_words(to) != to else "")
    print_answer(made, f"scene {made.scene}", json_=json_)


@app.command("remove")
def remove(name: Name, url: Url = "", json_: Json = False) -> None:
    """Remove a scene that no task is done in; its versions stay."""
    with connected(url) as station:
        removed = station.remove_scene(name)
    print_answer(removed, f"scene {name} is removed; bring it back with: teachpath scene restore {name}", json_=json_)


@app.command("restore")
def restore(name: Name, version: Number = None, url: Url = "", json_: Json = False) -> None:
    """Save a former version of a scene as its newest, or bring back one that was removed."""
    with connected(url) as station:
        newest = station.scene_versions(name)[0].number
        number = newest if version is None else version
        document = _without_name(asdict(station.get_scene(name, number).scene))
        saved = station.save_scene(name, document, base=newest, note=f"version {number} again")
    print_answer(saved, f"scene {name}, version {saved.number}", json_=json_)


def print_bodies(scene: dict[str, Any]) -> None:
    """Print what stands in a scene as columns."""
    carried = [("object", scene["carried"])] if scene["carried"] else []
    zones = [(role, zone) for role, key in (("keep in", "keep_in"), ("keep out", "keep_out")) for zone in scene[key]]
    rows = [
        (role, s["name"], s["kind"], " x ".join(f"{v:g}" for v in s["size"]), _place(s["position"]))
        for role, s in [*(("obstacle", shape) for shape in scene["obstacles"]), *carried, *zones]
    ]
    print_columns(("role", "name", "kind", "size [m]", "centre [m]"), rows, none=f"nothing stands in {scene['name']}")


def _place(position: list[float]) -> str:
    return ", ".join(f"{value:.3f}" for value in position)


def _without_name(scene: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in scene.items() if key != "name"}


def _scenes(file: Path) -> list[dict[str, Any]]:
    """Read the scenes of a file, with the corners of their meshes; raises UnusableInput."""
    document = _document(file)
    scenes = document.get("scenes", [document]) if isinstance(document, dict) else document
    if not (isinstance(scenes, list) and scenes and all(isinstance(scene, dict) for scene in scenes)):
        raise UnusableInput(f"{file} holds no scene: write one with obstacles, or a list of them as `scenes`")
    for number, scene in enumerate(scenes, start=1):
        if not isinstance(scene.setdefault("name", file.stem if len(scenes) == 1 else None), str):
            raise UnusableInput(f"scene {number} of {file} has no name; write one")
        for shape in _shapes(scene):
            if shape.get("kind") == "mesh" and isinstance(shape.get("file"), str) and not shape.get("vertices"):
                _read_mesh(shape, file.parent)
    return scenes


def _read_mesh(shape: dict[str, Any], folder: Path) -> None:
    from teachpath.io.meshes import read_mesh  # with the libraries of geometry

    max_pieces = shape.get("max_pieces", 1)
    if not isinstance(max_pieces, int):
        raise UnusableInput(f"max_pieces of {shape.get('name')} is {max_pieces!r}; write a whole number")
    shape["vertices"], shape["pieces"] = read_mesh(folder / shape["file"], max_pieces=max_pieces)


def _document(file: Path) -> Any:
    import tomllib

    try:
        text = file.read_text(encoding="utf-8")
        return json.loads(text) if file.suffix.lower() == ".json" else tomllib.loads(text)
    except OSError as error:
        raise UnusableInput(f"cannot read the scene {file}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:  # of TOML, JSON and UTF-8
        kind = "JSON" if file.suffix.lower() == ".json" else "TOML; a file in JSON ends in .json"
        raise UnusableInput(f"{file} is not {kind}: {error}") from None


def _shapes(scene: dict[str, Any]) -> list[dict[str, Any]]:
    lists = [scene.get(key) for key in ("obstacles", "keep_in", "keep_out")]
    found = [shape for listed in lists if isinstance(listed, list) for shape in listed] + [scene.get("carried")]
    return [shape for shape in found if isinstance(shape, dict)]
