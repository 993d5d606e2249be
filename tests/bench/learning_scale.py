"""python -m tests.bench.learning_scale: learning from thousands, each part in a process of its own.

So the memory of each is its own; with the name of a part and a number it measures that part and prints JSON.
"""

import json
import os
import resource
import subprocess
import sys
import time

import numba
import numpy as np

from teachpath.learning.clustering.average_linkage import MAX_SCIPY_DEMONSTRATIONS
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.kernels import _mean_distances, blocks_of
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.learn import learn
from teachpath.learning.selection.default_mode import select
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.bench.report import Figure, against, print_report
from tests.unit.learning import synthetic

POINTS = 150


def measure(*, quick: bool) -> list[Figure]:
    """Return the figures of clustering 10,000 and 25,000 demonstrations, and of selecting among 600."""
    sizes = (3000, 21_000, 60, 300, 300) if quick else (10_000, 25_000, 600, 1000, 10_000)
    values = {}
    for part, size in zip(("pairs", "crowd", "selection", "whole", "very_many"), sizes, strict=True):
        command = [sys.executable, "-m", "tests.bench.learning_scale", part, str(size)]
        environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}  # as in the processes of a station
        done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
        values |= json.loads(done.stdout)
    many, crowd, chosen, whole, very_many = sizes
    return [
        against(
            f"distances of {many:,} x {POINTS}", [values["pairs"]], "sample pairs/s",
            name="the kernel in the cache", value=values["ceiling"],
        ),
        against(f"clustering {many:,} x {POINTS}", [values["clustering"]], "s", name="limit", value=20.0),
        against("  its memory", [values["clustering_memory"]], "GB", name="limit", value=2.0),
        against("  longest wait for a cancel", [values["clustering_wait"]], "s", name="limit", value=1.0),
        Figure(f"clustering {crowd:,} x {POINTS} by a sample of 2,000", (values["crowd"],), "s"),
        Figure("  its memory", (values["crowd_memory"],), "GB"),
        Figure(f"selecting among {chosen} of one way", (values["selection"],), "s"),
        against("  longest wait for a cancel", [values["selection_wait"]], "s", name="limit", value=1.0),
        against(f"learning {whole:,} x {POINTS} whole", [values["whole"]], "s", name="limit", value=3.0),
        against(f"learning {very_many:,} x {POINTS} whole", [values["very_many"]], "s", name="limit", value=25.0),
        against("  its memory", [values["very_many_memory"]], "GB", name="limit", value=2.0),
    ]  # fmt: skip


class Waits:
    """The longest time between two looks at whether the work is cancelled."""

    def __init__(self) -> None:
        self.longest, self._last = 0.0, time.perf_counter()

    def __call__(self, *_: object) -> None:
        now = time.perf_counter()
        self.longest, self._last = max(self.longest, now - self._last), now


def paths(count: int) -> Array:
    """Return smooth random paths of five ways: (count, 150, 3) [m]."""
    rng = np.random.default_rng(1)
    t = np.linspace(0, 1, POINTS)
    waves = np.sin(np.pi * np.outer(t, np.arange(1, 5)))
    ways = rng.normal(0, 0.2, (5, 4, 3))[rng.integers(0, 5, count)]
    return np.asarray(waves @ (ways + rng.normal(0, 0.02, (count, 4, 3))) + t[:, None])


def pairs(count: int) -> dict[str, float]:
    """Measure the distances of all pairs beside the same arithmetic within the cache, and the clustering."""
    shown = paths(count)
    pairwise_distances(shown[:300])  # compiles
    cluster_paths(shown[:300], LearningSettings(), length=1.0, metric="arc")
    few = np.ascontiguousarray(shown[:64].transpose(0, 2, 1), dtype=np.float32)
    ceiling(few, blocks_of(few)[0], 1)
    began = time.perf_counter()
    ceiling(few, blocks_of(few)[0], 400)
    best = 400 * numba.get_num_threads() * len(few) ** 2 * POINTS / (time.perf_counter() - began)
    began = time.perf_counter()
    pairwise_distances(shown)
    rate = count * (count - 1) / 2 * POINTS / (time.perf_counter() - began)
    began, waits = time.perf_counter(), Waits()
    grouping = cluster_paths(shown, LearningSettings(), length=1.0, metric="arc", progress=waits)
    waits()
    seconds = time.perf_counter() - began
    assert grouping.labels.max() == 5
    return {
        "pairs": rate, "ceiling": best, "clustering": seconds, "clustering_memory": memory(),
        "clustering_wait": waits.longest,
    }  # fmt: skip


@numba.njit(parallel=True)
def ceiling(few: np.ndarray, block: np.ndarray, rounds: int) -> float:
    """Work out the distances of the same few paths again and again on every core."""
    threads = numba.get_num_threads()
    totals = np.zeros(threads)
    for thread in numba.prange(threads):
        means = np.empty(len(few), dtype=np.float32)
        for _ in range(rounds):
            for i in range(len(few)):
                _mean_distances(few[i], block, means)
                totals[thread] += means[i]
    return totals.sum()


def crowd(count: int) -> dict[str, float]:
    """Measure the clustering of more than are compared pair by pair."""
    shown = paths(count)
    cluster_paths(shown[:300], LearningSettings(), length=1.0, metric="arc")
    began = time.perf_counter()
    grouping = cluster_paths(shown, LearningSettings(), length=1.0, metric="arc")
    seconds = time.perf_counter() - began
    assert grouping.labels.max() == 5
    return {"crowd": seconds, "crowd_memory": memory()}


def selection(count: int) -> dict[str, float]:
    """Measure the selection within one way that was shown very often."""
    rng = np.random.default_rng(1)
    t = np.linspace(0, 1, POINTS)
    waves = np.sin(np.pi * np.outer(t, np.arange(1, 4)))
    steady = t[:, None] * np.array([0.6, 0.2, 0.1])
    times = 0.02 * np.arange(POINTS)
    members = {
        f"{i:04}": Trajectory(times, steady + waves @ rng.normal(0, 0.015, (3, 3)) + rng.normal(0, 0.001, (POINTS, 3)))
        for i in range(count)
    }
    began, waits = time.perf_counter(), Waits()
    select(1, members, LearningSettings(), on_step=waits)
    waits()
    return {"selection": time.perf_counter() - began, "selection_wait": waits.longest}


def whole(count: int) -> dict[str, float]:
    """Measure all of learning: clustering, selection and fitting of three ways."""
    rng = np.random.default_rng(1)
    shown = {
        str(i): synthetic.demonstration(rng, synthetic.WAY_POINTS[i % 3], duration=(POINTS - 1) * synthetic.PERIOD)
        for i in range(count)
    }
    learn(dict(list(shown.items())[: MAX_SCIPY_DEMONSTRATIONS + 10]), LearningSettings())  # compiles
    began = time.perf_counter()
    learned = learn(shown, LearningSettings())
    seconds = time.perf_counter() - began
    assert len(learned.paths) == 3
    return {"whole": seconds, "whole_memory": memory()}


def very_many(count: int) -> dict[str, float]:
    """Measure the same under other names."""
    found = whole(count)
    return {"very_many": found["whole"], "very_many_memory": found["whole_memory"]}


def memory() -> float:
    """Return the most memory that this process has had [GB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


if __name__ == "__main__":
    if sys.argv[1:] in ([], ["--quick"]):
        print_report("Learning from thousands", measure(quick="--quick" in sys.argv))
    else:
        print(json.dumps(globals()[sys.argv[1]](int(sys.argv[2]))))
