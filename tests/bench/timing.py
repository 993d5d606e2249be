"""Timing on eight paths: duration and a lower bound, time to plan, stops and the best possible, cost of a cycle."""

import time
from dataclasses import dataclass

import numpy as np

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import Governor, warm_up
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import Candidate, is_usable
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.limit_margins import NO_MARGINS, limit_uses
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.timing import duration_lower_bound, time_tool_path
from teachpath.nurbs import Curve
from tests.bench import answers, peer_bound
from tests.bench.global_optimum import best_duration
from tests.bench.optimum import shortest_stop
from tests.bench.report import Figure, against

ARM = Arm.of_variant()

RATE = 250.0
DT = 1.0 / RATE
BUDGET = 150.0  # us, of a moving cycle
RELAXED_LABEL = "no jerk limit, no reserve"
LONGEST_STOP = 0.45  # s
OPTIMA = 4  # stops per path and repetition that are held against the best possible


def measure(*, repeats: int) -> list[Figure]:
    """Return the figures; stops are from full speed; cycles, limits and answers over random commands."""
    warm_up(DT, ARM)
    figures: list[Figure] = []
    stops: list[float] = []
    ratios: list[float] = []
    tracks: list[TimedTrajectory] = []
    time_tool_path(*_branch(curves()["bow"]), ARM.limits.motion, rate=RATE)  # loads what the first path would wait for
    for name, curve in curves().items():
        found = _path(name, curve, repeats)
        figures += found.figures
        stops += found.stops
        ratios += found.ratios
        tracks.append(found.track)
    figures.append(against("all paths: stops from full speed", stops, "s", name="median allowed", value=0.3))
    figures.append(against("all paths: stop over the best possible", ratios, "", name="median allowed", value=1.05))
    return figures + answers.measure(tracks, DT, runs=20 * repeats)


@dataclass(frozen=True, eq=False)
class _Found:
    figures: list[Figure]
    track: TimedTrajectory
    stops: list[float]
    ratios: list[float]


def curves() -> dict[str, Curve]:
    """Return the paths: smooth, winding, tight, with a turn back, and noisy; cubic ones have jumps of jerk at knots."""
    rng = np.random.default_rng(7)
    y = np.linspace(-0.3, 0.3, 9)
    bow = np.column_stack([0.55 + 0.1 * np.cos(4 * y), y, 0.62 + 0.1 * np.cos(5 * y)])
    wave = np.column_stack([0.55 + 0.06 * (-1.0) ** np.arange(9), y, np.full(9, 0.62)])
    loop = bow.copy()
    loop[3:6] = bow[4] + [[0.0, 0.025, 0.02], [0.03, 0.0, 0.05], [0.0, -0.025, 0.02]]
    back = np.concatenate([bow[:6], bow[5:1:-1] + np.array([0.0, 0.0, 0.02])])
    noisy = np.column_stack([np.full(13, 0.55), np.linspace(-0.3, 0.3, 13), np.full(13, 0.64)])
    noisy += rng.normal(0.0, 0.022, noisy.shape)
    return {
        "bow": _clamped(bow, 5),
        "bow, cubic": _clamped(bow, 3),
        "slalom": _clamped(wave, 5),
        "slalom, cubic": _clamped(wave, 3),
        "small loop": _clamped(loop, 5),
        "turn back": _clamped(back, 5),
        "noisy": _clamped(noisy, 5),
        "noisy, cubic": _clamped(noisy, 3),
    }


def _clamped(points: np.ndarray, degree: int) -> Curve:
    inner = np.linspace(0.0, 1.0, len(points) - degree + 1)
    return Curve(degree, np.r_[np.zeros(degree), inner, np.ones(degree)], points, np.ones(len(points)))


def _branch(curve: Curve) -> tuple[ToolPath, Candidate]:
    settings = MotionSettings()
    found = sample_tool_path(curve, settings)
    return found, max(
        (c for c in enumerate_candidates(found, ARM, settings) if is_usable(c, settings)),
        key=lambda c: c.min_singular_value,
    )


def _path(name: str, curve: Curve, repeats: int) -> _Found:
    found, candidate = _branch(curve)
    seconds = []
    for _ in range(repeats):
        began = time.perf_counter()
        path, squared_rates = time_tool_path(found, candidate, ARM.limits.motion, rate=RATE)
        seconds.append(time.perf_counter() - began)
    track = time_joint_path(path, squared_rates, ARM.limits.motion)
    label = f"{name}, {found.lengths[-1]:.2f} m"
    bound = duration_lower_bound(found, candidate, ARM.limits.motion)
    stopped = _stops(track)
    stops = [DT * len(rates) for _, rates in stopped]
    apart = max(1, len(stopped) // (OPTIMA * repeats))
    some = stopped[apart // 2 :: apart]
    ratios = [DT * len(rates) / shortest_stop(track, tau, rates, DT) for tau, rates in some]
    cycles, used = _random_commands(track, runs=4 * repeats)
    figures = [
        against(f"{label}: duration", [track.duration], "s", name=RELAXED_LABEL, value=bound),
        *peer_bound.measure(label, found, candidate, ARM.limits.motion, bound),
        *_bounds(label, found, candidate, bound),
        against(f"{label}: timing it", seconds, "s", name="asked", value=0.5),
        against(f"{label}: stops from full speed", stops, "s", name="worst allowed", value=LONGEST_STOP),
        against(f"{label}: ways to rest from full speed", _ways(track), "s", name="worst allowed", value=LONGEST_STOP),
        Figure(f"{label}: stop over the best possible", tuple(ratios), ""),
        Figure(f"{label}: moving cycle p50", (float(np.median(cycles)),), "us"),
        against(f"{label}: moving cycle p99", [float(np.quantile(cycles, 0.99))], "us", name="budget", value=BUDGET),
        against(f"{label}: largest use of a limit", [used], "", name="limit", value=1.0),
    ]
    return _Found(figures, track, stops, ratios)


def _bounds(label: str, found: ToolPath, candidate: Candidate, bound: float) -> list[Figure]:
    """Return what the jerk limit and the reserve cost, and what a scheme with one box of limits takes."""
    path, squared_rates = time_tool_path(found, candidate, ARM.limits.motion, rate=RATE, margins=NO_MARGINS)
    whole = time_joint_path(path, squared_rates, ARM.limits.motion).duration
    free = ARM.limits.motion.scaled(1.0, 1.0, 20.0)
    easy = time_joint_path(*time_tool_path(found, candidate, free, rate=RATE, margins=NO_MARGINS), free)
    figures = (
        ("without any reserve", whole),
        ("without any reserve, best on a grid of everything", best_duration(path, ARM.limits.motion, whole)),
        ("without any reserve, 20 times the jerk", easy.duration),
        ("constant box", _box(found, candidate)),
    )
    return [
        against(f"{label}: duration, {what}", [duration], "s", name=RELAXED_LABEL, value=bound)
        for what, duration in figures
    ]


def _box(found: ToolPath, candidate: Candidate) -> float:
    """Return the shortest duration under constant limits of the length's speed, acceleration and jerk.

    Each term of the joints' acceleration and jerk is bounded by its largest anywhere, as a scheme must that knows one
    box of limits for the whole path.
    """
    path = JointPath(found.lengths, found.lengths, candidate.joints)
    first, second, third = (np.abs(path(path.dense_parameters(), k)[:, :6]).max(axis=0) + 1e-9 for k in (1, 2, 3))
    fastest = min(
        (ARM.limits.motion.speed / first).min(),
        np.sqrt(ARM.limits.motion.acceleration / second).min(),
        np.cbrt(ARM.limits.motion.jerk / third).min(),
    )
    durations = []
    for v in fastest * np.linspace(0.02, 0.999, 60):
        most = ((ARM.limits.motion.acceleration - second * v**2) / first).min()
        for a in most * np.linspace(0.05, 0.999, 20):
            j = ((ARM.limits.motion.jerk - third * v**3 - 3 * second * v * a) / first).min()
            if j > 0.0:
                durations.append(_rest_to_rest(found.lengths[-1], v, a, j))
    return float(min(durations))


def _rest_to_rest(length: float, v: float, a: float, j: float) -> float:
    """Return the time to cover a length from rest to rest (Biagiotti & Melchiorri 2008, section 3.4)."""
    a = min(a, np.sqrt(v * j))
    if length >= v * (v / a + a / j):
        return length / v + v / a + a / j
    if length >= 2 * a**3 / j**2:
        return a / j + np.sqrt((a / j) ** 2 + 4 * length / a)
    return 4 * np.cbrt(length / (2 * j))


def _stops(track: TimedTrajectory) -> list[tuple[float, list[float]]]:
    """Stop from full speed at many places; return plan times, and the rates after each period until it stands."""
    stopped = []
    for place in range(3, int(track.duration * RATE), 5):
        governor = Governor(track, DT)
        for _ in range(place):
            governor.step()
        governor.hold()
        rates = []
        while not governor.progress.at_rest:
            rates.append(governor.step().rate)
        stopped.append((place * DT, rates))
    return stopped


def _ways(track: TimedTrajectory) -> list[float]:
    """Return how long the way to rest lasts that travels with each setpoint at full speed [s]."""
    governor, ways = Governor(track, DT), []
    while not governor.step().finished:
        ways.append(DT * len(governor.way_to_rest().states))
    return ways


def _random_commands(track: TimedTrajectory, *, runs: int) -> tuple[np.ndarray, float]:
    """Return what moving cycles took [us] and the largest use of a limit, over random commands."""
    took, used = [], 0.0
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        governor = Governor(track, DT, override=rng.uniform(0.05, 1.0))
        commands = (
            governor.hold,
            governor.resume,
            governor.reverse,
            lambda governor=governor, rng=rng: governor.set_override(rng.uniform(0.05, 1.0)),
        )
        sent, wait = [governor.motion[0].copy()] * 4, 0
        for _ in range(1200):
            if wait == 0:
                commands[rng.integers(4)]()
                wait = int(rng.integers(1, 12 if seed % 2 else 160))
            wait -= 1
            began = time.perf_counter()
            moving = not governor.step().at_rest
            if moving:
                took.append(1e6 * (time.perf_counter() - began))
            sent.append(governor.motion[0].copy())
        used = max(used, *(float(use.max()) for use in limit_uses(np.array(sent), ARM.limits.motion, RATE)))
    return np.array(took), used
