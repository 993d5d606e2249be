"""Timing on eight paths: duration beside a lower bound, planning time, stops beside the best possible, cost of a cycle."""

import time

import numpy as np
from optimum import shortest_stop
from report import Figure, against

from teachpath.motion import MotionSettings
from teachpath.motion.governor import Governor, warm_up
from teachpath.motion.joints import ARM, JointPath
from teachpath.motion.route import Candidate, Route, candidates, route, usable
from teachpath.motion.timing import lower_bound, timed, uses
from teachpath.motion.track import Track, paced
from teachpath.nurbs import Curve

RATE = 250.0
DT = 1.0 / RATE
BUDGET = 150.0  # us, of a moving cycle
LONGEST_STOP = 0.5  # s
OPTIMA = 6  # stops per path that are held against the best possible


def measure(*, repeats: int) -> list[Figure]:
    """Return the figures; stops are from full speed, cycles and limits over random commands."""
    warm_up(DT)
    figures: list[Figure] = []
    for name, curve in curves().items():
        figures += _path(name, curve, repeats)
    return figures


def curves() -> dict[str, Curve]:
    """Return the paths: smooth, winding, tight, with a turn back, and noisy; cubic ones have jumps of jerk at knots."""
    rng = np.random.default_rng(7)
    y = np.linspace(-0.3, 0.3, 9)
    bow = np.column_stack([0.55 + 0.1 * np.cos(4 * y), y, 0.62 + 0.1 * np.cos(5 * y)])
    wave = np.column_stack([0.55 + 0.06 * (-1.0) ** np.arange(9), y, np.full(9, 0.62)])
    loop = bow.copy()
    loop[3:6] = bow[4] + [[0.0, 0.025, 0.02], [0.03, 0.0, 0.05], [0.0, -0.025, 0.02]]
    back = np.concatenate([bow[:6], bow[5:1:-1] + [0.0, 0.0, 0.02]])
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


def _path(name: str, curve: Curve, repeats: int) -> list[Figure]:
    settings = MotionSettings()
    found = route(curve, settings)
    candidate = max((c for c in candidates(found, settings) if usable(c, settings)), key=lambda c: c.singular)
    seconds = []
    for _ in range(repeats):
        began = time.perf_counter()
        path, pace = timed(found, candidate, ARM, rate=RATE)
        seconds.append(time.perf_counter() - began)
    track = paced(path, pace, ARM)
    label = f"{name}, {found.lengths[-1]:.2f} m"
    bound = lower_bound(found, candidate, ARM)
    places, stops = _stops(track)
    best = [shortest_stop(track, place, DT) for place in places[:: max(1, len(places) // OPTIMA)]]
    ours = stops[:: max(1, len(places) // OPTIMA)]
    cycles, used = _random_commands(track, runs=4 * repeats)
    return [
        against(f"{label}: duration", [track.duration], "s", name="no jerk limit, no reserve", value=bound),
        against(f"{label}: one constant box instead", [_box(found, candidate)], "s", name="this plan", value=track.duration),
        against(f"{label}: timing it", seconds, "s", name="asked", value=0.5),
        against(f"{label}: stops from full speed", stops, "s", name="worst allowed", value=LONGEST_STOP),
        Figure(f"{label}: stops / best possible", tuple(a / b for a, b in zip(ours, best, strict=True)), "x"),
        against(f"{label}: moving cycle p99", [float(np.quantile(cycles, 0.99))], "us", name="budget", value=BUDGET),
        Figure(f"{label}: moving cycle", (float(np.median(cycles)),), "us"),
        against(f"{label}: largest use of a limit", [used], "x", name="limit", value=1.0),
    ]


def _box(found: Route, candidate: Candidate) -> float:
    """Return at least what a constant limit of speed along the length takes, as the steepest place asks it."""
    path = JointPath(found.lengths, found.lengths, candidate.joints)
    first, second, third = (np.abs(path(path.dense(), k)[:, :6]).max(axis=0) for k in (1, 2, 3))
    slowest = max((first / ARM.speed).max(), np.sqrt(second / ARM.acceleration).max(), np.cbrt(third / ARM.jerk).max())
    return float(found.lengths[-1] * slowest)


def _stops(track: Track) -> tuple[list[int], list[float]]:
    places = list(range(3, int(track.duration * RATE), 5))
    stops = []
    for place in places:
        governor = Governor(track, DT)
        for _ in range(place):
            governor.step()
        governor.hold()
        cycles = 0
        while not governor.progress.standing:
            governor.step()
            cycles += 1
        stops.append(DT * cycles)
    return places, stops


def _random_commands(track: Track, *, runs: int) -> tuple[np.ndarray, float]:
    """Return what moving cycles took [us] and the largest use of a limit, over random commands."""
    took, used = [], 0.0
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        governor = Governor(track, DT, override=rng.uniform(0.05, 1.0))
        sent = [governor.motion[0].copy()] * 4
        wait = 0
        for _ in range(1200):
            if wait == 0:
                rng.choice([governor.hold, governor.resume, governor.reverse, lambda: governor.set_override(rng.uniform(0.05, 1))])()
                wait = int(rng.integers(1, 12 if seed % 2 else 160))
            wait -= 1
            began = time.perf_counter()
            moving = not governor.step().standing
            if moving:
                took.append(1e6 * (time.perf_counter() - began))
            sent.append(governor.motion[0].copy())
        used = max(used, *(float(use.max()) for use in uses(np.array(sent), ARM, RATE)))
    return np.array(took), used
