import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import ruckig

import teachpath.motion
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import MAX_REVERSE_RATE, Governor
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import is_usable
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.limit_margins import SYMMETRIC_MARGINS, limit_uses
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.timing import time_tool_path
from teachpath.nurbs import Curve
from tests.unit.motion.ways import FAR_X, NEAR_X, hooked, wandering, way

ARM = Arm.of_variant()

DT = 0.004
LIMIT = 1.0 + 1e-9
CURVES = {"near": way(NEAR_X).curve, "far": way(FAR_X, degree=5).curve, "hooked": hooked(), "wandering": wandering(1)}


def track_of(curve: Curve) -> TimedTrajectory:
    settings = MotionSettings()
    found = sample_tool_path(curve, settings)
    candidate = next(c for c in enumerate_candidates(found, ARM, settings) if is_usable(c, settings))
    return time_joint_path(*time_tool_path(found, candidate, ARM.limits.motion, rate=1 / DT), ARM.limits.motion)


@pytest.fixture(scope="module")
def tracks() -> dict[str, TimedTrajectory]:
    line = straight_move(
        np.zeros(6), np.array([1.0, -0.4, 0.2, 0.0, 0.9, 2.0]), ARM.limits.motion, arm=ARM, margins=SYMMETRIC_MARGINS
    )
    return {"line": line} | {name: track_of(curve) for name, curve in CURVES.items()}


class Log:
    """Steps a governor and keeps what it sends."""

    def __init__(self, governor: Governor) -> None:
        self.governor = governor
        self.sent = [governor.motion[0].copy()] * 4

    def step(self) -> None:
        self.governor.step()
        self.sent.append(self.governor.motion[0].copy())

    def until(self, done: Callable[[], bool], *, within: int) -> int:
        for cycles in range(within):
            if done():
                return cycles
            self.step()
        raise AssertionError(f"not done within {within} cycles: {self.governor.progress}")

    def stands(self) -> bool:
        return self.governor.progress.at_rest

    def finished(self) -> bool:
        return self.governor.progress.finished

    def most_used(self) -> float:
        rest = [self.sent[-1]] * 3 if self.stands() else []
        return float(max(use.max() for use in limit_uses(np.array(self.sent + rest), ARM.limits.motion, 1 / DT)))


def command(governor: Governor, rng: np.random.Generator) -> None:
    match rng.integers(6):
        case 0:
            governor.set_override(rng.uniform(0.0, 1.0))
        case 1:
            governor.set_override(1.0)
        case 2:
            governor.hold()
        case 3 | 4:
            governor.resume()
        case _:
            governor.reverse()


@pytest.mark.parametrize("pause", [3, 12, 120])
@pytest.mark.parametrize("name", ["line", *CURVES])
def test_no_sequence_of_commands_breaks_a_limit(tracks: dict[str, TimedTrajectory], name: str, pause: int) -> None:
    for seed in range(8):
        rng = np.random.default_rng(seed)
        log = Log(Governor(tracks[name], DT, override=rng.uniform(0.05, 1.0)))
        wait = 0
        for _ in range(700):
            if wait == 0:
                command(log.governor, rng)
                wait = int(rng.integers(1, pause + 1))
            wait -= 1
            log.step()
        log.governor.resume()
        log.governor.set_override(1.0)
        log.until(log.finished, within=1500)
        assert log.most_used() < LIMIT
        np.testing.assert_array_equal(log.sent[-1], tracks[name].table[-1, 0])


@pytest.mark.parametrize("name", ["line", *CURVES])
def test_every_setpoint_has_a_way_to_rest_on_the_track_within_all_limits(
    tracks: dict[str, TimedTrajectory], name: str
) -> None:
    fine = tracks[name](np.linspace(0.0, tracks[name].duration, 4001))[:, :6]
    for seed in range(3):
        rng = np.random.default_rng(seed)
        log = Log(Governor(tracks[name], DT, override=rng.uniform(0.05, 1.0)))
        for cycle in range(600):
            if rng.random() < 0.05:
                command(log.governor, rng)
            log.step()
            way = log.governor.way_to_rest()
            if not len(way.states):
                assert log.governor.progress.at_rest
                continue
            np.testing.assert_allclose(way.states[-1, 0], tracks[name](np.array([way.tau]))[0, :6], atol=1e-9)
            sent = np.array(log.sent[-3:])[:, :6]
            rows = np.vstack([sent, way.states[:, 0], np.repeat(way.states[-1:, 0], 3, axis=0)])
            uses = [np.abs(np.diff(rows, k, axis=0)) / DT**k for k in (1, 2, 3)]
            for use, limit in zip(uses, (ARM.limits.speed, ARM.limits.acceleration, ARM.limits.jerk), strict=True):
                assert np.all(use <= limit * LIMIT)
            if cycle % 60 == 0:
                off = np.abs(way.states[:, 0, None] - fine).max(axis=2).min(axis=1)
                assert off.max() <= np.abs(np.diff(fine, axis=0)).max()


def test_it_goes_on_from_the_end_of_a_way_to_rest_in_its_direction(tracks: dict[str, TimedTrajectory]) -> None:
    for reverse in (False, True):
        log = Log(Governor(tracks["near"], DT))
        log.until(lambda log=log: log.governor.tau > 0.5 * tracks["near"].duration, within=2000)
        if reverse:
            log.governor.reverse()
            log.until(lambda log=log: log.governor.state[1] < -0.3, within=2000)
        way = log.governor.way_to_rest()
        log.governor.restart_at(way.tau, held=False)
        np.testing.assert_allclose(log.governor.motion[0, :6], way.states[-1, 0], atol=1e-12)
        assert log.governor.reversing is reverse
        log.until(lambda log=log: log.governor.progress.at_rest, within=10)  # it begins from rest
        for _ in range(50):
            log.step()
        assert (log.governor.tau < way.tau) is reverse


@pytest.mark.parametrize("name", ["line", *CURVES])
def test_a_hold_from_any_place_at_full_speed_stands_soon(tracks: dict[str, TimedTrajectory], name: str) -> None:
    track = tracks[name]
    stops, ways = [], []
    for start in range(1, int(track.duration / DT), 7):
        log = Log(Governor(track, DT))
        log.until(lambda log=log, start=start: len(log.sent) >= start + 4, within=2000)  # type: ignore[misc]
        ways.append(DT * len(log.governor.way_to_rest().states))
        log.governor.hold()
        stops.append(DT * log.until(log.stands, within=200))
        assert log.most_used() < LIMIT
    assert np.median(stops) <= 0.4
    assert max(stops + ways) <= 0.45


def test_undisturbed_it_takes_the_time_of_its_track(tracks: dict[str, TimedTrajectory]) -> None:
    for track in tracks.values():
        log = Log(Governor(track, DT))
        assert (log.until(log.finished, within=5000) - 1) * DT <= track.duration <= (len(log.sent) - 4) * DT


def test_the_way_is_the_same_at_every_rate_and_back(tracks: dict[str, TimedTrajectory]) -> None:
    track = tracks["near"]
    log = Log(Governor(track, DT, override=0.37))
    log.until(lambda: log.governor.progress.s > 0.4, within=2000)
    log.governor.reverse()
    log.until(lambda: log.governor.progress.s < 0.3, within=500)
    log.governor.resume()
    log.governor.set_override(0.9)
    log.until(log.finished, within=2000)
    tool = tool_pose(np.array(log.sent)[:, :6], ARM)[:, :3, 3]
    wanted = tool_pose(track(np.linspace(0.0, track.duration, 100_000))[:, :6], ARM)[:, :3, 3]
    for point in tool[::10]:
        assert np.linalg.norm(wanted - point, axis=1).min() < 1e-4


def test_reverse_goes_back_to_the_beginning_and_resume_on_to_the_end(tracks: dict[str, TimedTrajectory]) -> None:
    log = Log(Governor(tracks["far"], DT))
    log.until(lambda: log.governor.progress.s > 0.3, within=500)
    log.governor.reverse()
    fastest = 0.0
    while not log.stands() or log.governor.progress.s > 0.0:
        log.step()
        fastest = min(fastest, log.governor.progress.rate)
    assert -MAX_REVERSE_RATE <= fastest < -0.5
    assert log.governor.progress.s == 0.0
    assert not log.finished()
    log.step()
    assert log.stands()
    log.governor.resume()
    log.until(log.finished, within=500)
    assert np.diff([s[6] for s in log.sent]).min() < 0.0
    assert log.most_used() < LIMIT


def test_hold_comes_to_rest_and_stays_until_resumed(tracks: dict[str, TimedTrajectory]) -> None:
    log = Log(Governor(tracks["near"], DT))
    log.until(lambda: log.governor.progress.s > 0.3, within=500)
    log.governor.hold()
    log.step()
    assert not log.stands()
    log.until(log.stands, within=130)
    held = log.governor.progress
    for _ in range(50):
        log.step()
    assert log.governor.progress == held
    assert not held.finished
    log.governor.resume()
    log.until(log.finished, within=500)


def test_an_override_sets_the_rate(tracks: dict[str, TimedTrajectory]) -> None:
    log = Log(Governor(tracks["near"], DT, override=0.25))
    log.step()
    assert log.governor.progress.rate == 0.25
    log.governor.set_override(0.6)
    log.until(lambda: log.governor.progress.rate == 0.6, within=100)


def longest_wait(track: TimedTrajectory, rng: np.random.Generator, *, steady: bool) -> int:
    """Change the override every 40 to 640 ms on the way; when `steady`, only once the rate is constant."""
    governor = Governor(track, DT, override=rng.uniform(0.05, 1.0))
    pause, waited, longest = 0, 0, 0
    while not governor.progress.finished:
        if pause <= 0 and not (steady and governor.state[2]):
            governor.set_override(rng.uniform(0.05, 1.0))
            pause = rng.integers(10, 160)
        pause -= 1
        governor.step()
        waited = 0 if governor.ramp_end_rate == governor.target_rate or governor.progress.finished else waited + 1
        longest = max(longest, waited)
    return longest


@pytest.mark.parametrize("name", ["line", *CURVES])
def test_at_a_constant_rate_any_override_is_answered_in_the_same_period(
    tracks: dict[str, TimedTrajectory], name: str
) -> None:
    assert all(longest_wait(tracks[name], np.random.default_rng(seed), steady=True) == 0 for seed in range(20))


@pytest.mark.parametrize("name", ["line", *CURVES])
def test_amid_a_turn_any_override_is_answered_within_a_tenth_of_a_second(
    tracks: dict[str, TimedTrajectory], name: str
) -> None:
    assert all(longest_wait(tracks[name], np.random.default_rng(seed), steady=False) * DT < 0.1 for seed in range(20))


@pytest.mark.parametrize("share", [0.0, float("nan"), -1.0])
def test_an_override_of_zero_or_nan_holds(tracks: dict[str, TimedTrajectory], share: float) -> None:
    log = Log(Governor(tracks["far"], DT))
    log.until(lambda: log.governor.progress.s > 0.2, within=500)
    log.governor.set_override(share)
    assert log.governor.held
    log.until(log.stands, within=130)


def test_the_motion_it_tells_is_the_derivative_of_what_it_sends(tracks: dict[str, TimedTrajectory]) -> None:
    governor = Governor(tracks["far"], 1e-4, override=0.8)
    told = []
    for cycle in range(9000):
        governor.step()
        told.append(governor.motion[:, :6].copy())
        if cycle == 3000:
            governor.set_override(0.3)
    at = np.array(told)
    for order in (0, 1):
        slope = (at[2:, order] - at[:-2, order]) / 2e-4
        np.testing.assert_allclose(slope, at[1:-1, order + 1], atol=0.01 * np.abs(at[:, order + 1]).max())


def test_ruckig_is_never_given_waypoints() -> None:
    # With waypoints the ruckig wheel posts the problem to a network service.
    room = Path(teachpath.motion.__file__).parent
    named = [file.name for file in room.rglob("*.py") if re.search("intermediate_positions", file.read_text())]
    assert not named
    assert ruckig.InputParameter(1).intermediate_positions == []
