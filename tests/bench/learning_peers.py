"""Learning beside the libraries it is usually written with: geomdl, FITPACK and hmmlearn's own mixture model."""

import contextlib
import io
import logging
import time
import warnings
from collections.abc import Callable

import numpy as np
from geomdl import fitting as geomdl_fitting
from hmmlearn.hmm import GMMHMM
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.interpolate import BSpline, make_lsq_spline, splev, splprep
from scipy.spatial import cKDTree

from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.fitting.nurbs_fit import approximate, distances_to_curve
from teachpath.learning.learn import learn
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed
from teachpath.learning.selection.features import positions_and_velocities
from teachpath.learning.selection.likelihoods import COURSE_STATES
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.bench.report import Figure, against

BOUND = 0.005  # m
DEGREE = 3
MAX_CONTROL_POINTS = 60  # control points
ITERATIONS = 8  # of Baum-Welch, as in ours
SEEN_POINTS = 2001  # samples of a peer's curve that stand for it


def fits(*, repeats: int) -> list[Figure]:
    """Return how long 300 and 30,000 noisy points take to follow within 5 mm, and what the peers take for the same.

    A peer is given the number of control points or the smoothing with which it first keeps the bound; the search for it
    is not counted.
    """
    points = noisy(300)
    ours = approximate(points, BOUND, degree=DEGREE, most=MAX_CONTROL_POINTS)
    seconds = timed(lambda: approximate(points, BOUND, degree=DEGREE, most=MAX_CONTROL_POINTS), repeats)
    figures = [
        against("fit of 300 noisy points within 5 mm", seconds, "s", name="limit", value=0.0015),
        against("  its control points", [float(len(ours.curve.weights))], "", name="limit", value=13.0),
        against(
            "  its largest distance",
            [float(distances_to_curve(ours.curve, points).max())],
            "m",
            name="bound",
            value=BOUND,
        ),
    ]
    for name, made in peers(points).items():
        if made is None:
            figures.append(
                Figure(f"  {name}: bound not kept with {MAX_CONTROL_POINTS} control points", (float("nan"),), "s")
            )
            continue
        call, count = made
        own = timed(call, 1 if "geomdl" in name else repeats)
        figures.append(Figure(f"  {name}, {count} control points", tuple(own), "s", *beside(seconds, own)))
    many = noisy(30_000)
    slow = timed(lambda: approximate(many, BOUND, degree=DEGREE, most=MAX_CONTROL_POINTS), max(repeats // 2, 1))
    count = len(approximate(many, BOUND, degree=DEGREE, most=MAX_CONTROL_POINTS).curve.weights)
    figures.append(against(f"fit of 30,000 noisy points, {count} control points", slow, "s", name="limit", value=1.0))
    return figures


def peers(points: Array) -> dict[str, tuple[Callable[[], object], int] | None]:
    """Return for every peer the call that first keeps the bound, and its number of control points."""
    u = arc_lengths(points) / arc_lengths(points)[-1]
    found: dict[str, tuple[Callable[[], object], int] | None] = {}

    def lsq(count: int) -> BSpline:
        inner = np.quantile(u, np.linspace(0, 1, count - DEGREE + 1)[1:-1])
        knots = np.concatenate([np.zeros(DEGREE + 1), inner, np.ones(DEGREE + 1)])
        return make_lsq_spline(u, points, knots, DEGREE)

    def keeps(curve: Callable[[Array], Array]) -> bool:
        return bool(cKDTree(curve(np.linspace(0, 1, SEEN_POINTS))).query(points)[0].max() <= BOUND)

    count = next((n for n in range(DEGREE + 1, MAX_CONTROL_POINTS + 1) if keeps(lsq(n))), None)
    found["scipy make_lsq_spline, even knots"] = count and (lambda: lsq(count), count)
    for s in np.geomspace(len(points) * BOUND**2, len(points) * 1e-7, 60):
        tck = splprep(points.T, u=u, s=s, k=DEGREE)[0]
        if keeps(lambda at, tck=tck: np.column_stack(splev(at, tck))):
            size = len(tck[0]) - DEGREE - 1
            found["scipy splprep, smoothing"] = (lambda s=s: splprep(points.T, u=u, s=s, k=DEGREE), size)
            break
    listed = points.tolist()
    for size in range(count or MAX_CONTROL_POINTS, MAX_CONTROL_POINTS + 1, 2):
        twin = geomdl_fitting.approximate_curve(listed, DEGREE, ctrlpts_size=size)
        twin.sample_size = SEEN_POINTS
        if cKDTree(np.array(twin.evalpts)).query(points)[0].max() <= BOUND:
            found["geomdl approximate_curve"] = (
                lambda size=size: geomdl_fitting.approximate_curve(listed, DEGREE, ctrlpts_size=size), size
            )  # fmt: skip
            break
    return found


def pipeline(trajectories: dict[str, Trajectory], *, repeats: int) -> list[Figure]:
    """Return how long learning takes, and the same steps written with hmmlearn's `GMMHMM` and geomdl."""
    what = f"learning {len(trajectories)} demonstrations"
    full = timed(lambda: learn(trajectories, LearningSettings()), repeats)
    plain = timed(lambda: learn(trajectories, LearningSettings(repeats=0)), repeats)
    began = time.perf_counter()
    models, broken = usual(trajectories)
    theirs = [time.perf_counter() - began]
    return [
        against(f"{what}, with 8 repetitions for the stability", full, "s", name="limit", value=0.5),
        Figure(f"{what}, without", tuple(plain), "s"),
        Figure(
            f"  by GMMHMM and approximate_curve, {broken} of {models} models broken", tuple(theirs), "s",
            *beside(plain, theirs),
        ),
    ]  # fmt: skip


def usual(trajectories: dict[str, Trajectory]) -> tuple[int, int]:
    """Cluster, score each demonstration by models of the others, and fit a curve to each way, with other libraries.

    Returns:
        models trained, and how many of them hmmlearn could not train or score.
    """
    paths = [smoothed(trajectory) for trajectory in trajectories.values()]
    condensed = pairwise_distances(np.stack([at_equal_arc_length(path, 100) for path in paths]))
    labels = fcluster(linkage(condensed, "average"), 3, "maxclust")
    models = broken = 0
    for way in np.unique(labels):
        members = np.flatnonzero(labels == way)
        listed = list(trajectories.values())
        sequences = positions_and_velocities([listed[i] for i in members])
        for left in range(len(members)):
            models += 1
            rest = [sequence for i, sequence in enumerate(sequences) if i != left]
            broken += not _scored(rest, sequences[left], COURSE_STATES)
        course = np.mean([at_equal_arc_length(paths[i], 200) for i in members], axis=0)
        for count in range(DEGREE + 1, MAX_CONTROL_POINTS + 1):
            twin = geomdl_fitting.approximate_curve(course.tolist(), DEGREE, ctrlpts_size=count)
            twin.sample_size = 400
            if cKDTree(np.array(twin.evalpts)).query(course)[0].max() <= BOUND:
                break
    return models, broken


def _scored(rest: list[Array], one: Array, states: int) -> bool:
    model = GMMHMM(states, n_mix=2, covariance_type="diag", n_iter=ITERATIONS, random_state=1, init_params="mcw")
    model.startprob_ = np.eye(states)[0]
    moves = np.eye(states) + np.eye(states, k=1)
    model.transmat_ = moves / moves.sum(axis=1, keepdims=True)
    with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
        warnings.simplefilter("ignore")
        try:
            model.fit(np.concatenate(rest), [len(sequence) for sequence in rest])
            return bool(np.isfinite(model.score(one)))
        except ValueError:
            return False


def beside(ours: list[float], theirs: list[float]) -> tuple[str, float]:
    """Return the last two fields of a peer's figure: how many times ours it takes."""
    return "times ours", float(np.median(theirs) / np.median(ours))


def noisy(count: int) -> Array:
    """Return a path that crosses itself, recorded at 50 Hz, with 1 mm of tremor and 0.7 mm of noise: (n, 3) [m]."""
    rng = np.random.default_rng(1)
    t = np.linspace(0, 1, count)
    angle = 2 * np.pi * (1.6 * t - 0.2)
    path = np.column_stack([0.5 * t, 0.1 * np.sin(angle), 0.2 + 0.1 * np.cos(angle)])
    rates, phases = rng.uniform(4, 9, (3, 3)), rng.uniform(0, 2 * np.pi, (3, 3))
    seconds = 0.02 * np.arange(count)[:, None, None]
    tremor = 0.001 / np.sqrt(3) * np.sin(2 * np.pi * rates * seconds + phases).sum(axis=1)
    return np.asarray(path + tremor + rng.normal(0, 0.0007, path.shape))


def timed(work: Callable[[], object], repeats: int) -> list[float]:
    """Return how many seconds each of several calls takes."""
    seconds = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - began)
    return seconds


logging.getLogger("hmmlearn").setLevel(logging.ERROR)
