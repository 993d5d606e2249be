"""How soon a command is answered, in virtual time: periods until the motion is on a ramp to the rate asked for.

An answer that takes longer than it may is looked into: whether a grid of ramps, finer and wider than what the governor
has time for, has one in that time that keeps every limit. Where it has none, it could not be had.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from teachpath.motion.execution.governor import Governor
from teachpath.motion.timing import kernels, ramp_checks
from teachpath.motion.timing.timed_trajectory import TimedTrajectory
from tests.bench.report import Figure, against

ALLOWED_SHARE = 0.1  # s
ROUNDING = 1e-9  # s
PERIODS = 1200  # of a run
SLOPES = np.geomspace(0.05, 2000.0, 50)  # 1/s^2, of the ramps on the grid
JERKS = np.geomspace(0.5, 50_000.0, 50)  # 1/s^3

State = tuple[np.ndarray, np.ndarray]  # plan time, rate and its slope; what was sent (see `ramp_checks.advance`)
Commands = Callable[[Governor, np.random.Generator], None]


@dataclass
class Answers:
    """Waits [s] of commands that were answered or given up for the next, and how many late ones could be had sooner."""

    waits: list[float] = field(default_factory=list)
    missed: int = 0

    @property
    def late(self) -> int:
        """How many took longer than allowed."""
        return sum(wait > ALLOWED_SHARE + ROUNDING for wait in self.waits)


def measure(tracks: list[TimedTrajectory], dt: float, *, runs: int) -> list[Figure]:
    """Return the figures over all tracks; commands come every 40 to 640 ms, most of them amid the turn before."""
    figures = []
    for what, command in (("override changes", _override), ("holds, reverses, resumes, override changes", _any)):
        found = Answers()
        for track in tracks:
            for seed in range(runs):
                _run(track, dt, command, np.random.default_rng(seed), found)
        in_time = 100.0 * (1.0 - found.late / len(found.waits))
        figures += [
            against(
                f"all paths: answer to {len(found.waits):,} {what}",
                found.waits,
                "s",
                name="allowed",
                value=ALLOWED_SHARE,
            ),
            Figure(f"  in time; {found.missed} of {found.late} later ones could be had sooner", (in_time,), "%"),
        ]
    return figures


def _run(track: TimedTrajectory, dt: float, command: Commands, rng: np.random.Generator, found: Answers) -> None:
    """Add the answers to random commands; whatever comes to rest before its answer needs none."""
    governor = Governor(track, dt, override=rng.uniform(0.05, 1.0))
    pause, waiting = 0, None
    for _ in range(PERIODS):
        if pause == 0:
            _account(track, dt, governor.target_rate, waiting, found)
            command(governor, rng)
            pause, waiting = int(rng.integers(10, 160)), []
        pause -= 1
        before = governor.state, governor.sent
        governor.step()
        if waiting is None:
            continue
        waiting.append(before)
        if governor.ramp_end_rate == governor.target_rate:
            _account(track, dt, governor.target_rate, waiting, found)
            waiting = None
        elif governor.progress.at_rest:
            waiting = None


def _account(track: TimedTrajectory, dt: float, wish: float, waiting: list[State] | None, found: Answers) -> None:
    """Add a wait for a rate, period by period, and whether a late answer could be had in time."""
    if not waiting:
        return
    found.waits.append(dt * len(waiting))
    if found.waits[-1] > ALLOWED_SHARE + ROUNDING:
        in_time = waiting[: round(ALLOWED_SHARE / dt)]
        found.missed += any(_possible(track, dt, wish, *state) for state in in_time)


def _possible(track: TimedTrajectory, dt: float, wish: float, state: np.ndarray, sent: np.ndarray) -> bool:
    """Tell whether any ramp on the grid leads from a state to a rate within all limits."""
    limits = np.stack([track.limits.speed * dt, track.limits.acceleration * dt**2, track.limits.jerk * dt**3])
    ramp = np.empty(8)
    for slope in SLOPES:
        for jerk in JERKS:
            drawn = kernels.shortest_ramp(ramp, state, wish, max(slope, abs(state[2])), jerk) >= 0.0
            if (
                drawn
                and ramp_checks.check_ramp(track.table, track.step, ramp, sent, limits, dt)[0]
                == ramp_checks.LIMITS_KEPT
            ):
                return True
    return False


def _override(governor: Governor, rng: np.random.Generator) -> None:
    governor.set_override(rng.uniform(0.05, 1.0))


def _any(governor: Governor, rng: np.random.Generator) -> None:
    acts = (governor.hold, governor.resume, governor.reverse, lambda: _override(governor, rng))
    acts[rng.integers(len(acts))]()
