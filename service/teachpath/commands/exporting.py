"""export: demonstrations, review packages and motions as files."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.options import Config, Data, Json, Url, connected, opened_store, stored_settings, with_arm
from teachpath.commands.printing import print_answer, print_json
from teachpath.commands.progress import progress_bar
from teachpath.commands.references import find_execution, find_plan
from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    from teachpath.config import Settings

app: typer.Typer = typer.Typer(help="Write demonstrations, review packages and motions to files.", no_args_is_help=True)

Into = Annotated[Path, typer.Option(help="Folder to write into; made when missing.")]
Out = Annotated[Path, typer.Option("-o", "--out", help="File to write; never one that is there already.")]
Format = Annotated[str, typer.Option(help="csv; for ROS 2 json, cdr, mcap (a bag); urscript, rapid, krl, ls.")]
Rate = Annotated[float | None, typer.Option(help="Instants a second [Hz]; left out: as the format usually has.")]


@app.command("demonstrations")
def demonstrations(
    what: Annotated[str, typer.Argument(help="A task, or the id of one demonstration.")],
    format: Annotated[
        str,
        typer.Option(
            help="csv or mcap (every sample), lerobot (a dataset of version 3.0), lerobot-2.1, trajectory (the "
            "object's, csv), archive (the task as a zip file, with a SHA-256 of each file)."
        ),
    ] = "mcap",
    into: Into = Path(),
    number: Annotated[list[int] | None, typer.Option(help="Only these demonstrations; may be repeated.")] = None,
    all_: Annotated[bool, typer.Option("--all", help="Also rejected, discarded and bad ones.")] = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Write demonstrations to files.

    csv, mcap and archive can be imported again without a loss. Nothing is overwritten, and nothing half written stays.
    """
    settings = stored_settings(config, data)
    written, left_out = _written(what, format, into, numbers=number or (), all_=all_, settings=settings)
    folder = Path(settings.store.data_dir).absolute()
    if json_:
        print_json({"files": list(map(str, written)), "data": str(folder), "left_out": left_out})
        return
    for file in written:
        print(file)
    print(f"from {folder}", file=sys.stderr)
    if left_out:
        print(f"{left_out} rejected, discarded or bad ones are left out; --all writes them too", file=sys.stderr)


@app.command("report")
def report(
    run: Annotated[str, typer.Argument(help="Id of a learning run, or a task: its newest.")],
    into: Into = Path(),
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Write the review package of a learning run, as one HTML file."""
    settings = stored_settings(config, data)
    try:
        into.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UnusableInput(f"cannot make {into}: {error.strerror}; give another folder with --into") from None
    _review(run, into / f"{run}.html", settings, json_=json_)


@app.command("plan")
def plan(
    plan: Annotated[str, typer.Argument(help="An id of a plan or its beginning, TASK/CLUSTER, or last.")],
    out: Out,
    format: Format = "csv",
    rate: Rate = None,
    url: Url = "",
    json_: Json = False,
) -> None:
    """Write the motion of a plan along its path for another program.

    Only a plan whose certificate holds leaves. The head of the file says what was proved, and what is not covered.
    """
    with connected(url) as station:
        content = station.program(find_plan(station, plan), format, rate=rate)
    _write_new(out, content, json_=json_)


@app.command("execution")
def execution(
    execution: Annotated[str, typer.Argument(help="An id of an execution that has ended, its beginning, or last.")],
    out: Out,
    format: Format = "csv",
    rate: Rate = None,
    url: Url = "",
    json_: Json = False,
) -> None:
    """Write what the arm was sent in an execution for another program."""
    with connected(url) as station:
        content = station.executed_program(find_execution(station, execution), format, rate=rate)
    _write_new(out, content, json_=json_)


def _write_new(file: Path, content: bytes, *, json_: bool) -> None:
    """Write a file that is not there yet, whole or not at all."""
    try:
        with file.open("xb") as out:
            try:
                out.write(content)
            except OSError:
                with suppress(OSError):
                    file.unlink()
                raise
    except FileExistsError:
        raise UnusableInput(f"{file} is there already; give another place with --out, or move it away") from None
    except OSError as error:
        raise UnusableInput(f"cannot write {file}: {error.strerror}; give another place with --out") from None
    print_answer({"file": str(file), "bytes": len(content)}, f"{file}: {len(content)} bytes", json_=json_)


def _written(
    what: str, kind: str, into: Path, *, numbers: Sequence[int], all_: bool, settings: Settings
) -> tuple[Sequence[Path], int]:
    """Write demonstrations; returns the files, and how many are left out."""
    from teachpath.offline.exporting import chosen, export_demonstrations
    from teachpath.recorder.annotations import Annotations
    from teachpath.robot.scenes import Scenes

    with opened_store(settings) as store:
        known = what in {task.name for task in store.tasks()}
        rows = chosen(store, what, numbers=numbers, all_=all_) if known else [store.demonstration(what)]
        with progress_bar("exporting") as show:
            scenes = Scenes(store.scenes, settings.scenes)
            trajectory = Annotations(store, settings.recording, scenes.get).trajectory
            written = export_demonstrations(store, rows, kind, into, trajectory=trajectory, progress=show)
        left_out = len(store.demonstrations(what)) - len(rows) if known and not numbers else 0
    return written, left_out


def _review(run: str, file: Path, settings: Settings, *, json_: bool) -> None:
    from teachpath.offline.report import review_of, write_package
    from teachpath.recorder.annotations import Annotations
    from teachpath.robot.scenes import Scenes

    settings = with_arm(settings)
    with opened_store(settings) as store:
        scenes = Scenes(store.scenes, settings.scenes)
        review = review_of(
            store,
            run,
            scene=scenes.get,
            trajectory=Annotations(store, settings.recording, scenes.get).trajectory,
            motion=settings.motion,
            arm=settings.arm,
            robot=settings.bus.robot,
            dwell=settings.executor.dwell,
        )
    size = write_package(review, file)
    paths, moving = len(review.run.learned.paths), review.count("motion")
    said = {"file": str(file), "bytes": size, "paths": paths, "moving": moving}
    print_answer(said, f"{file}: {size / 1e6:.1f} MB, {paths} paths, {moving} of them move", json_=json_)
