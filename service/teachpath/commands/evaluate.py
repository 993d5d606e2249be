"""Commands evaluate and diff: the accuracy of learning on recordings of known groups; why two runs differ."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import comb
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.commands.options import Config, Data, Json, connected, settings_of, stored_settings
from teachpath.commands.printing import print_answer
from teachpath.commands.progress import progress_bar
from teachpath.errors import NotFound, UnusableRecording
from teachpath.lengths import describe_length

if TYPE_CHECKING:
    from teachpath.learning.evaluation import OneWay
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

    All groups are learned as if they were one task, and the clusters found are compared with the groups. Then each
    group is learned alone: is it one way, how many are left out (with the 95 % interval), and how far is each
    demonstration from what the others predict from its start and goal? The command needs neither a service nor a data
    folder.
    """
    from teachpath.learning.evaluation import evaluate_way, predicted_names
    from teachpath.learning.learn import learn
    from teachpath.learning.settings import StepCounter, Subprogress

    changes: dict[str, Any] = {"mode": mode} if mode else {}
    settings = settings_of(config, None).learning_with(
        changes if threshold is None else {**changes, "threshold": threshold}
    )
    grouped = read_groups(folder, format, units=units, rate=rate)
    named = {group: {f"{group}/{i}": t for i, t in enumerate(shown, 1)} for group, shown in grouped.items()}
    pooled = {name: trajectory for shown in named.values() for name, trajectory in shown.items()}
    with progress_bar("evaluating") as show:
        learned = learn(pooled, settings, progress=Subprogress(show, 0.0, 0.3))
        steps = sum(1 + len(predicted_names(shown)) for shown in named.values())
        on_step = StepCounter(Subprogress(show, 0.3, 1.0), steps, "learning each group alone")
        alone = {group: evaluate_way(shown, settings, on_step=on_step) for group, shown in named.items()}
    report = evaluation(learned) | {"alone": alone_report(alone)}
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
    json_: Json = False,
) -> None:
    """Say why the paths of two learning runs differ: inputs, settings, versions, clusters, selection, paths."""
    from teachpath.io.store.store import Store
    from teachpath.learning.compare import compare

    if url:
        with connected(url) as station:
            before, after = _fetched(station, one), _fetched(station, other)
    else:
        store = Store(stored_settings(config, data).store)
        try:
            before, after = store.run(one).learned, store.run(other).learned
        finally:
            store.close()
    sentences = compare(before, after)
    print_answer({"differences": sentences}, *(sentences or ["the two runs are the same"]), json_=json_)


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


def alone_report(alone: Mapping[str, OneWay]) -> list[dict[str, Any]]:
    """Say how each group is learned alone, and last all of them together, ready for JSON."""
    rows = [_alone_row(group, [found]) for group, found in alone.items()]
    return rows if len(rows) == 1 else [*rows, _alone_row("all", list(alone.values()))]


def _alone_row(group: str, found: Sequence[OneWay]) -> dict[str, Any]:
    from statistics import median

    from teachpath.learning.evaluation import Rate

    predicted = [each for one in found for each in one.predicted]
    row: dict[str, Any] = {
        "group": group,
        "ways": sum(one.ways for one in found),
        "ambiguous": sum(one.is_ambiguous for one in found),
        "left_out": Rate(sum(one.left_out.hits for one in found), sum(one.left_out.n for one in found)).document(),
        "predicted": None,
        "unpredicted": "; ".join(dict.fromkeys(one.unpredicted for one in found if one.unpredicted)),
    }
    if predicted:
        rms, line = median(each.rms for each in predicted), median(each.line for each in predicted)
        held = Rate(sum(each.held for each in predicted), len(predicted)).document()
        row["predicted"] = {"rms": rms, "of_the_line": rms / line if line else None, "held_by_two_sd": held}
    return row


def _flags(cluster: Cluster, of_path: str) -> list[str]:
    told = [f"{s.demonstration}: {s.note}" for s in cluster.scores if s.note and not s.selected]
    return [*filter(None, (cluster.note, cluster.ambiguous, of_path)), *told]


def _print(report: Mapping[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table

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
    _print_alone(report["alone"])
    for note in report["notes"]:
        print(f"note: {note}")
    for cluster in clusters:
        for flag in cluster["flags"]:
            print(f"cluster {cluster['cluster']}: {flag}")


def _print_alone(rows: Sequence[Mapping[str, Any]]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Each group alone", title_justify="left")
    for head in (
        "Group",
        "Ways",
        "Ambiguous",
        "Left out",
        "Predicted within",
        "Of a straight line's",
        "Held by two sd",
    ):
        table.add_column(head, justify="left" if head == "Group" else "right")
    for row in rows:
        predicted = row["predicted"] or {}
        share = predicted.get("of_the_line")
        table.add_row(
            row["group"],
            str(row["ways"]),
            str(row["ambiguous"]),
            _rate_in_words(row["left_out"]),
            _length_in_words(predicted.get("rms")),
            "" if share is None else f"{share:.2f}",
            _rate_in_words(predicted["held_by_two_sd"]) if predicted else "",
        )
    Console(width=None if sys.stdout.isatty() else 140).print(table)
    for row in rows:
        if row["unpredicted"] and row["group"] != "all":
            print(f"group {row['group']} is not predicted: {row['unpredicted']}")


def _rate_in_words(rate: Mapping[str, Any]) -> str:
    low, high = rate["interval"]
    return f"{rate['hits']} of {rate['n']} ({100 * low:.0f} to {100 * high:.0f} %)"


def _length_in_words(metres: float | None) -> str:
    return "" if metres is None else describe_length(metres)


def _fetched(station: Station, run: str) -> Learned:
    from teachpath.io.documents import from_document
    from teachpath.records import Learned

    for task in station.tasks():
        if run in (found.id for found in station.runs(task.name)):
            return from_document(Learned, asdict(station.get_run(task.name, run).learned))
    raise NotFound(f"there is no run {run!r}; list them with: teachpath runs")
