"""Commands evaluate and diff: the accuracy of learning on recordings of known groups; why two runs differ."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import comb
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.work import progress_bar
from teachpath.errors import NotFound, UnusableRecording
from teachpath.lengths import describe_length
from teachpath.records import Cluster, Learned, Trajectory
from teachpath_client.station import Station

SUFFIXES = {"csv": ".csv", "robottasks": ".npy"}


def evaluate(
    folder: Annotated[Path, typer.Argument(help="Folder whose files and sub-folders are one group each.")],
    format: Annotated[str, typer.Option(help="csv or robottasks; by the endings of the files unless given.")] = "",
    mode: Annotated[str, typer.Option(help="default, paper or repaired; that of the settings unless given.")] = "",
    threshold: Annotated[float | None, typer.Option(help="Height of the cut [m]; mode paper needs it.")] = None,
    units: Annotated[str, typer.Option(help="Of the positions: m, cm, mm or in; robottasks is in cm.")] = "",
    rate: Annotated[float, typer.Option(help="[Hz] for a format without a clock.")] = 50.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")] = False,
    config: Config = None,
) -> None:
    """Learn from recordings of known groups and say how accurate the result is.

    All groups are learned as if they were one task; the clusters found are compared with the groups. The command needs
    neither a service nor a data folder.
    """
    from teachpath.learning.learn import learn

    changes: dict[str, Any] = {"mode": mode} if mode else {}
    settings = settings_of(config, None).learning_with(
        changes if threshold is None else {**changes, "threshold": threshold}
    )
    grouped = read_groups(folder, format, units=units, rate=rate)
    pooled = {f"{group}/{i}": t for group, trajectories in grouped.items() for i, t in enumerate(trajectories, 1)}
    with progress_bar("evaluating") as show:
        learned = learn(pooled, settings, progress=show)
    report = evaluation(learned)
    if as_json:
        print(json.dumps(report, allow_nan=False, indent=2))
    else:
        _print(report)


def diff(
    one: Annotated[str, typer.Argument(metavar="RUN", help="Id of a learning run.")],
    other: Annotated[str, typer.Argument(metavar="RUN", help="Id of another, usually a later one.")],
    url: Annotated[str, typer.Option(help="Address of a service that has both; else the data folder is read.")] = "",
    config: Config = None,
    data: Data = None,
) -> None:
    """Say why the paths of two learning runs differ: inputs, settings, versions, clusters, selection, paths."""
    from teachpath.io.store.store import Store
    from teachpath.learning.compare import compare

    if url:
        with Station(url) as station:
            before, after = _fetched(station, one), _fetched(station, other)
    else:
        store = Store(settings_of(config, data).store)
        try:
            before, after = store.run(one).learned, store.run(other).learned
        finally:
            store.close()
    sentences = compare(before, after)
    print("\n".join(sentences) if sentences else "the two runs are the same")


def read_groups(folder: Path, format: str, *, units: str, rate: float) -> dict[str, list[Trajectory]]:
    """Read the recordings of a folder: every file in it is one group, and every sub-folder.

    Args:
        format: csv or robottasks; empty = the one whose files are there.
        units: of the positions; empty = those of the format.
        rate: [Hz] of a format without a clock.

    Raises:
        UnusableRecording: the folder holds no such files or files of both kinds, or a file is wrong.
    """
    from teachpath.io.import_settings import ImportSettings
    from teachpath.io.readers.contract import ReadOptions
    from teachpath.io.readers.registry import read_motions

    if not folder.is_dir():
        raise UnusableRecording(f"{folder} is not a folder")
    if format and format not in SUFFIXES:
        raise UnusableRecording(f"format {format!r} is unknown; known: {', '.join(SUFFIXES)}")
    files = {kind: sorted(folder.rglob(f"*{ending}")) for kind, ending in SUFFIXES.items()}
    kinds = [format] if format else [kind for kind in SUFFIXES if files[kind]]
    if len(kinds) > 1:
        raise UnusableRecording(f"{folder} holds {' and '.join(kinds)} files; say which with --format")
    if not kinds or not files[kinds[0]]:
        raise UnusableRecording(f"{folder} holds no {' or '.join(SUFFIXES[kind] for kind in kinds or SUFFIXES)} files")
    grouped: dict[str, list[Trajectory]] = {}
    for file in files[kinds[0]]:
        first = file.relative_to(folder).parts[0]
        name = file.stem if first == file.name else first
        try:
            content = file.read_bytes()
        except OSError as error:
            raise UnusableRecording(f"cannot read {file}: {error.strerror}") from None
        options = ReadOptions(units=units, rate=rate)
        tracks = read_motions(content, file.name, kinds[0], options, ImportSettings()).tracks
        grouped.setdefault(name, []).extend(t.trajectory() for t in tracks)
    return grouped


def adjusted_rand_index(one: Sequence[str | int], other: Sequence[str | int]) -> float:
    """Return the agreement of two partitions (Hubert & Arabie 1985): 1 when they are the same, 0 by chance."""
    pairs = sum(comb(n, 2) for n in Counter(zip(one, other, strict=True)).values())
    left, right = (sum(comb(n, 2) for n in Counter(labels).values()) for labels in (one, other))
    expected = left * right / max(comb(len(one), 2), 1)
    best = (left + right) / 2
    # Both all in one or both all apart: the index is 0/0, and they agree.
    return 1.0 if best == expected else (pairs - expected) / (best - expected)


def evaluation(learned: Learned) -> dict[str, Any]:
    """Compare what was learned with the known groups, ready for JSON; ids of demonstrations are `group/number`."""
    truth = {name: name.rsplit("/", 1)[0] for name in learned.demonstrations}
    found = {name: cluster.index for cluster in learned.clusters for name in cluster.members}
    names = learned.demonstrations
    fits = {path.cluster: (path, asdict(path.fit) if path.fit else {}) for path in learned.paths}
    return {
        "mode": learned.mode,
        "demonstrations": len(names),
        "groups": dict(Counter(truth.values())),
        "adjusted_rand_index": adjusted_rand_index([truth[name] for name in names], [found[name] for name in names]),
        "threshold": learned.threshold,
        "clusters": [
            {
                "cluster": cluster.index,
                "groups": dict(sorted(Counter(truth[name] for name in cluster.members).items())),
                "selected": sum(score.selected for score in cluster.scores),
                "degree": fits[cluster.index][0].curve.degree,
                "control_points": len(fits[cluster.index][0].curve.control_points),
                **fits[cluster.index][1],
                "flags": _flags(cluster, fits[cluster.index][0].note),
            }
            for cluster in learned.clusters
        ],
        "notes": list(learned.notes),
        "settings": learned.settings,
        "versions": learned.versions,
    }


def _flags(cluster: Cluster, of_path: str) -> list[str]:
    told = [f"{s.demonstration}: {s.note}" for s in cluster.scores if s.note and not s.selected]
    return [*filter(None, (cluster.note, cluster.ambiguous, of_path)), *told]


def _print(report: Mapping[str, Any]) -> None:
    clusters, groups = report["clusters"], report["groups"]
    title = (
        f"{report['demonstrations']} demonstrations of {len(groups)} {'group' if len(groups) == 1 else 'groups'}, "
        f"{len(clusters)} {'cluster' if len(clusters) == 1 else 'clusters'} found (mode {report['mode']}, "
        f"cut at {describe_length(report['threshold'], digits=3)})"
    )
    table = Table()
    table.add_column("Cluster", justify="right")
    table.add_column("Groups")
    for name in ("Selected", "Degree", "Control points", "Largest error", "RMS error", "Fréchet", "Tube radius"):
        table.add_column(name, justify="right")
    for cluster in clusters:
        table.add_row(
            str(cluster["cluster"]),
            ", ".join(f"{count} {name}" for name, count in cluster["groups"].items()),
            f"{cluster['selected']} of {sum(cluster['groups'].values())}",
            str(cluster["degree"]),
            str(cluster["control_points"]),
            *(_length_in_words(cluster[name]) for name in ("largest", "rms", "frechet", "tube")),
        )
    print(title)
    Console(width=None if sys.stdout.isatty() else 140).print(table)
    print(f"adjusted Rand index {report['adjusted_rand_index']:.3f} (1: clusters and groups are the same)")
    for note in report["notes"]:
        print(f"note: {note}")
    for cluster in clusters:
        for flag in cluster["flags"]:
            print(f"cluster {cluster['cluster']}: {flag}")


def _length_in_words(metres: float | None) -> str:
    return "" if metres is None else describe_length(metres)


def _fetched(station: Station, run: str) -> Learned:
    from teachpath.io.documents import from_document

    for task in station.tasks():
        if run in (found.id for found in station.runs(task.name)):
            return from_document(Learned, asdict(station.get_run(task.name, run).learned))
    raise NotFound(f"there is no run {run!r}")
