"""import, export and doctor: work on the data folder itself."""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from teachpath.app import trajectory_of
from teachpath.commands.options import Config, Data, settings_of
from teachpath.errors import UnusableRecording
from teachpath.io.store import Store
from teachpath.offline.doctor import examine
from teachpath.offline.importing import Source, import_file
from teachpath.records import Trajectory
from teachpath.workers.calibrations import Calibrations


def import_(
    task: Annotated[str, typer.Argument(help="Task to add demonstrations to; made when missing.")],
    file: Annotated[list[Path], typer.Argument(help="Files to import.")],
    format: Annotated[str, typer.Option(help="csv (t,x,y,z[,qw,qx,qy,qz]), robottasks (.npy) or mcap.")] = "",
    units: Annotated[str, typer.Option(help="Of the positions: m, cm, mm or in; robottasks is in cm.")] = "",
    rate: Annotated[float, typer.Option(help="[Hz] for a format without a clock.")] = 50.0,
    scene: Annotated[str, typer.Option(help="Scene of a new task.")] = "empty",
    calibration: Annotated[str, typer.Option(help="Mapping of the file's frame to the world.")] = "",
    config: Config = None,
    data: Data = None,
) -> None:
    """Make demonstrations from files.

    Every motion in a file becomes one, with the same verdict as a live recording. The service need not run.
    """
    settings = settings_of(config, data)
    robottasks = format == "robottasks"
    store = Store(settings.store)
    try:
        calibrations = Calibrations(store, settings.recording, settings.calibrations, settings.scene)
        chosen = calibrations.get(calibration or ("robottasks" if robottasks else "identity"))
        for each in file:
            try:
                content = each.read_bytes()
            except OSError as error:
                raise UnusableRecording(f"cannot read {each}: {error.strerror}") from None
            kind = format or ("mcap" if each.suffix == ".mcap" else "csv")
            source = Source(each.name, content, kind, units or ("cm" if robottasks else "m"), rate)
            made = import_file(
                store, settings.recording, source, task=task, scene=settings.scene(scene), calibration=chosen
            )
            for d, _ in made:
                print(f"{task} {d.number}: {d.samples} samples, {d.duration:.2f} s, {d.verdict} ({d.id})")
    finally:
        store.close()


def export(
    demonstration: Annotated[str, typer.Argument(help="Id of the demonstration.")],
    format: Annotated[str, typer.Option(help="csv (the object's trajectory) or mcap (every sample).")] = "csv",
    out: Annotated[Path | None, typer.Option(help="File to write; csv goes to the terminal without it.")] = None,
    config: Config = None,
    data: Data = None,
) -> None:
    """Write a demonstration to a file."""
    settings = settings_of(config, data)
    store = Store(settings.store)
    try:
        row = store.demonstration(demonstration)
        if format == "mcap":
            content = store.recordings.path(row.recording).read_bytes()
        elif format == "csv":
            content = _csv(trajectory_of(store, settings, row)).encode()
        else:
            raise UnusableRecording(f"format {format!r} is unknown; known: csv, mcap")
    finally:
        store.close()
    if out is not None:
        out.write_bytes(content)
    else:
        sys.stdout.buffer.write(content)


def doctor(config: Config = None, data: Data = None) -> None:
    """Repair recordings that a crash cut off.

    Says what each of them holds and makes demonstrations of it; the torn files are kept. Stop the service first.
    """
    settings = settings_of(config, data)
    store = Store(settings.store)
    try:
        scenes = {scene.name: scene for scene in settings.scenes}
        findings = examine(store, settings.recording, scenes, Path(settings.store.data_dir))
    finally:
        store.close()
    for finding in findings:
        print(finding.sentence)
    if not findings:
        print(f"{settings.store.data_dir}: every recording is whole")


def _csv(trajectory: Trajectory) -> str:
    turned = trajectory.orientations
    columns = [trajectory.times[:, None], trajectory.positions] + ([] if turned is None else [turned])
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["t", "x", "y", "z"] + ([] if turned is None else ["qw", "qx", "qy", "qz"]))
    writer.writerows([repr(v) for v in row] for row in np.hstack(columns).tolist())
    return text.getvalue()
