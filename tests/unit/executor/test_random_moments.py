"""Whatever happens to setpoints at whatever moment of whatever path, the player asks nothing beyond a limit."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
import pytest

from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.execution.governor import Governor
from teachpath.motion.timing.timed_trajectory import TimedTrajectory
from teachpath_client.driver import PlayerState, Setpoint, SetpointPlayer
from tests.unit.executor.played_setpoints import ARM, DELAY, off_path
from tests.unit.motion.execution.test_governor import DT, track_of
from tests.unit.motion.ways import wandering

PATHS, MOMENTS = 10, 100
STEPS = 2  # of the player, in a control period
OFF_PATH = 1e-5  # m
ROUNDING = 1.0 + 1e-6
EPOCH = 1_700_000_000 * 10**9
LIMITS = (ARM.limits.speed, ARM.limits.acceleration, ARM.limits.jerk)
DISTURBANCES = ("the sender dies", "it stops", "late", "lost", "doubled", "in bursts")


@dataclass(frozen=True, eq=False)
class Path:
    """A path, and the setpoints that were sent on it."""

    track: TimedTrajectory
    sent: list[Setpoint]


def streamed(track: TimedTrajectory, seed: int) -> Path:
    """Return what an executor sends on a path: at full speed, or, on every other path, at speeds that change."""
    rng, governor, sent = np.random.default_rng(seed), Governor(track, DT), []
    while not governor.progress.finished:
        way = governor.way_to_rest().states
        motion = governor.motion[:, :6].copy()
        nominal = EPOCH + round(1e9 * DT * len(sent))
        sent.append(Setpoint(len(sent), nominal, *motion, gripper_closed=False, execution="e", way_to_rest=way))
        if seed % 2 and len(sent) % 40 == 0:
            governor.set_override(rng.uniform(0.3, 1.0))
        governor.step()
    return Path(track, sent)


def arrivals(what: str, first: int, count: int, rng: np.random.Generator) -> Iterator[tuple[float, int]]:
    """Yield when [s] which setpoints come, from `first` on, whose turn it is at a moment."""
    pause = {"the sender dies": np.inf, "it stops": rng.uniform(0.02, 0.5)}.get(what, 0.0)
    for cycle in range(first, count):
        due = DT * cycle + pause
        if what == "late":
            due += rng.uniform(0.0, 0.012) if rng.random() < 0.95 else rng.uniform(0.05, 0.3)
        if what == "in bursts":
            due = DT * (first + (cycle - first) // 12 * 12 + 12)
        if what != "lost" or rng.random() >= 0.05:
            yield due, cycle
        if what == "doubled":
            yield due + rng.uniform(0.0, 0.05), cycle


def play(player: SetpointPlayer, path: Path, coming: list[tuple[float, int]], begin: int, seconds: float) -> np.ndarray:
    """Play on from a step on, until the arm rests or for so long; returns positions (n, 6), one a step."""
    log, waiting = [], sorted(coming, reverse=True)
    for step in range(begin, begin + round(seconds / DT * STEPS)):
        now = EPOCH + round(1e9 * DT * step / STEPS)
        while waiting and waiting[-1][0] <= DT * step / STEPS:
            player.add(path.sent[waiting.pop()[1]], now)
        player.advance(DT / STEPS, now)
        log.append(player.target.position)
        if player.state is PlayerState.STOPPED:
            return np.array([*log, *log[-1:] * (4 * STEPS)])
    return np.array(log)


def uses(played: np.ndarray) -> np.ndarray:
    """The largest use of the limits of speed, acceleration and jerk by differences, at every phase of a period."""
    found = []
    for order, limit in enumerate(LIMITS, 1):
        change = played
        for _ in range(order):
            change = change[STEPS:] - change[:-STEPS]
        found.append((np.abs(change) / DT**order / limit).max())
    return np.array(found)


@pytest.mark.parametrize("seed", range(PATHS))
def test_at_no_moment_of_any_path_do_setpoints_that_fail_break_a_limit_or_leave_the_path(seed: int) -> None:
    path, rng = streamed(track_of(wandering(seed)), seed), np.random.default_rng(seed)
    tool = tool_pose(path.track(np.linspace(0.0, path.track.duration, 4000))[:, :6], ARM)[:, :3, 3]
    player, before, begin = SetpointPlayer(path.sent[0].position, delay=DELAY), path.sent[0].position[None], 0
    for cycle in np.sort(rng.integers(1, len(path.sent), MOMENTS)):
        until = int(cycle) * STEPS
        while begin < until:
            now = EPOCH + round(1e9 * DT * begin / STEPS)
            if begin % STEPS == 0:
                player.add(path.sent[begin // STEPS], now)
            player.advance(DT / STEPS, now)
            before = np.vstack([before[-3 * STEPS :], player.target.position])
            begin += 1
        what = DISTURBANCES[int(rng.integers(len(DISTURBANCES)))]
        coming = list(arrivals(what, int(cycle), len(path.sent), rng))
        played = play(deepcopy(player), path, coming, begin, 0.6)
        assert off_path(played, tool) <= OFF_PATH, (what, cycle)
        assert np.all(uses(np.vstack([before, played])) <= ROUNDING), (what, cycle, uses(np.vstack([before, played])))
