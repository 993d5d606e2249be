"""make experiments: the paper's experiments in every mode, as a report with figures in reports/."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import platform
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from tests.experiments import (
    ablation,
    adaptation,
    clustering,
    degrees,
    figures,
    recorded_sets,
    report,
    results,
    rule,
    scale,
    stream_faults,
    targets,
    trials,
)
from tests.experiments.scenarios import GROUPINGS, SCENARIOS, SHAPES
from tests.experiments.selection_cases import CASES

REPORTS = Path(__file__).parents[2] / "reports"
PROCESSES = 2
CHUNK = 5  # runs sent to a process at once
SEED = 1  # of the single runs that tables and pictures show
# What is repeated, in the order of the outcomes of `_repeated`.
EXPERIMENT_PARTS = (
    "selection",
    "grouping",
    "shapes",
    "repetitions",
    "scale",
    "degrees",
    "adaptation",
    "ablation",
    "stream faults",
    "clustering",
    "faultless streams",
    "recorded sets",
)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True)
class Sizes:
    """How often each experiment is run."""

    selection: int = 1000
    ablation: int = 400
    grouping: int = 100
    clustering: int = 200
    shape: int = 20
    degree: int = 12
    fault: int = 100
    faultless: int = 25  # batches
    datasets: int = 30
    repetitions: int = 40
    adaptation: int = 50
    mixture: int = 40

    def reduced(self, share: float) -> Sizes:
        """Return a share of the runs, at least one of each."""
        return Sizes(**{name: max(1, round(share * count)) for name, count in asdict(self).items()})


QUICK_SIZES = Sizes(
    selection=8,
    ablation=8,
    grouping=4,
    clustering=4,
    shape=1,
    degree=1,
    fault=2,
    faultless=1,
    datasets=3,
    repetitions=8,
    adaptation=2,
    mixture=2,
)


def main() -> None:
    """Run everything and write the report."""
    parser = argparse.ArgumentParser(description="Run the experiments of the paper in every mode.")
    parser.add_argument("--quick", action="store_true", help="few runs: to see the report, not to believe it")
    parser.add_argument("--hands", type=Path, help="folder of hand-polhemus, for adapted paths; else synthetic ones")
    parser.add_argument("--sets", type=Path, help="folder of RoboTasks, for recorded sets; else they are left out")
    parser.add_argument("--share", type=float, default=1.0, help="of the runs, e.g. 0.1; the intervals tell its price")
    parser.add_argument("--out", type=Path, default=REPORTS, help="folder of the report")
    asked = parser.parse_args()
    for name in THREADS:
        os.environ[name] = "1"  # read by the processes to come: they are many enough
    sizes = QUICK_SIZES if asked.quick else Sizes().reduced(asked.share)
    asked.out.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    outcomes, parts = _repeated(sizes, asked.hands, asked.sets)
    *repeated, adapted, scored, faulty, clustered, faultless, mixed = outcomes
    found = results.summary(*repeated, sizes=sizes)
    found["adaptation"] = adaptation.summary({count: outcome for (_, count, *_), outcome in adapted})
    found["stream_faults"] = stream_faults.summary(faulty, (batch for _, batch in faultless))
    found["ablation"] = ablation.summary([(key, scores) for (key, _), scores in scored])
    found["clustering"] = clustering.summary([(key, told) for (key, _), told in clustered])
    found["recorded_sets"] = recorded_sets.summary([(count, mixture) for (_, count, _), mixture in mixed])
    shown_1, learned_1 = trials.table_1(SEED)
    shown_2, learned_2 = trials.experiment_2(SEED)
    found["experiment_1"] = results.single(learned_1, shown_1)
    found["experiment_2"] = results.single(learned_2, shown_2)
    pictures = {
        "fig4_convergence": partial(figures.convergence, learned=learned_1),
        "fig5_paths": partial(figures.paths, demonstrations=shown_1, learned=learned_1),
        "fig6_wiggles": partial(figures.wiggles, demonstrations=shown_2, learned=learned_2),
        "rejection": partial(figures.rejection, rates=results.outranked(found)),
        "rule": partial(rule.draw, rule=found["rule"]),
        "places": partial(figures.places, rates=results.by_place(found)),
        "repetitions": partial(figures.repetitions, rates=found["repetitions"]["rates"]),
        "groupings": partial(figures.groupings, rates=results.right(found)),
        "shapes": figures.shapes,
    }
    _draw(asked.out, pictures)
    found["made"] = {
        **_circumstances(asked.quick),
        "hands": asked.hands is not None,
        "seconds": round(time.monotonic() - began),
        "processor_seconds": parts,
    }
    (asked.out / "experiments.json").write_text(json.dumps(found, indent=1, allow_nan=False) + "\n")
    (asked.out / "experiments.html").write_text(report.page(found, asked.out))
    targets.print_short(found)
    of_parts = ", ".join(f"{name} {seconds}" for name, seconds in sorted(parts.items(), key=lambda part: -part[1]))
    print(f"seconds of a processor: {of_parts}")
    print(f"{asked.out / 'experiments.html'}, {found['made']['seconds']} s")


def _repeated(sizes: Sizes, hands: Path | None, sets: Path | None) -> tuple[tuple[list[Any], ...], dict[str, int]]:
    """Run all that is repeated, in processes.

    Returns:
        the outcomes of each of `EXPERIMENT_PARTS`, see `results.summary`, and how long each took [s of a processor].
    """
    work: list[tuple[int, Callable[..., Any], tuple[Any, ...]]] = []
    work += [(0, trials.select_once, (scenario.key, run)) for scenario in SCENARIOS for run in range(sizes.selection)]
    work += [(1, trials.group_once, (ways.key, seed)) for ways in GROUPINGS for seed in range(sizes.grouping)]
    work += [(2, trials.fit_once, (shape, seed)) for shape in SHAPES for seed in range(sizes.shape)]
    work += [(3, trials.repeat_once, (dataset, sizes.repetitions)) for dataset in range(sizes.datasets)]
    work += [(4, scale.scale_once, (dataset,)) for dataset in range(sizes.datasets)]
    work += [(5, degrees.degrees_once, (kind, seed)) for kind in degrees.KINDS for seed in range(sizes.degree)]
    work += [(6, adaptation.measure, (hands, count, sizes.adaptation, SEED)) for count in adaptation.COUNTS]
    work += [(7, ablation.score_once, (key, run)) for key in CASES for run in range(sizes.ablation)]
    work += [
        (8, stream_faults.fault_once, (*case, seed)) for case in stream_faults.CASES for seed in range(sizes.fault)
    ]
    work += [(9, clustering.cluster_once, (key, seed)) for key in clustering.CASES for seed in range(sizes.clustering)]
    work += [(10, stream_faults.faultless_batch, (batch,)) for batch in range(sizes.faultless)]
    if sets is not None:
        counts = recorded_sets.drawn_counts(sizes.mixture)
        work += [(11, recorded_sets.mixed_once, (sets, count, seed)) for seed, count in enumerate(counts)]
    chunks = [work[at : at + CHUNK] for at in range(0, len(work), CHUNK)]
    gathered: dict[Future[list[Any]], int] = {}
    context = multiprocessing.get_context("spawn")
    with _bar() as bar, ProcessPoolExecutor(PROCESSES, mp_context=context) as pool:
        row = bar.add_task("runs", total=len(work))
        for number, chunk in enumerate(chunks):
            gathered[pool.submit(_chunk, chunk)] = number
        for done in as_completed(gathered):
            bar.advance(row, len(done.result()))
    found: tuple[list[Any], ...] = tuple([] for _ in EXPERIMENT_PARTS)
    taken = [0.0] * len(EXPERIMENT_PARTS)
    for done, number in gathered.items():
        for (kind, _, arguments), (outcome, seconds) in zip(chunks[number], done.result(), strict=True):
            found[kind].append((arguments, outcome))
            taken[kind] += seconds
    return found, {name: round(seconds) for name, seconds in zip(EXPERIMENT_PARTS, taken, strict=True)}


def _chunk(work: Sequence[tuple[int, Callable[..., Any], tuple[Any, ...]]]) -> list[tuple[Any, float]]:
    return [_timed(function, arguments) for _, function, arguments in work]


def _timed(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[Any, float]:
    """Call a function; return what it returns, and how long that took of this process [s]."""
    began = time.process_time()
    outcome = function(*arguments)
    return outcome, time.process_time() - began


def _draw(folder: Path, pictures: dict[str, Callable[[Path], None]]) -> None:
    with _bar() as bar:
        row = bar.add_task("figures", total=len(pictures))
        for name, draw in pictures.items():
            draw(folder / f"{name}.png")
            bar.advance(row)


def _bar() -> Progress:
    columns = (TextColumn("{task.description:<8}"), BarColumn(), MofNCompleteColumn())
    return Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=Console(stderr=True))


def _circumstances(quick: bool) -> dict[str, Any]:
    names = ("teachpath", "numpy", "scipy", "hmmlearn", "numba")
    return {
        "quick": quick,
        "processes": PROCESSES,
        "seed": SEED,
        "machine": f"{os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}",
        "versions": {name: version(name) for name in names},
    }


if __name__ == "__main__":
    main()
