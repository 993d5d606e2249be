import numpy as np
import pytest

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import Candidate, is_usable
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.jerk_limited_topp import minimize_duration
from teachpath.motion.timing.limit_margins import NO_MARGINS, Margins, limit_uses
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.timing import duration_lower_bound, time_tool_path
from teachpath.motion.timing.velocity_profile import max_squared_rates, reach_times
from teachpath.nurbs import Curve
from tests.unit.motion.ways import FAR_X, MIDDLE, NEAR_X, clamped, hooked, wandering, way

ARM = Arm.of_variant()

RATE = 250.0


def on_a_branch(curve: Curve) -> tuple[ToolPath, Candidate]:
    settings = MotionSettings()
    found = sample_tool_path(curve, settings)
    return found, max(
        (c for c in enumerate_candidates(found, ARM, settings) if is_usable(c, settings)),
        key=lambda c: c.min_singular_value,
    )


def fastest(curve: Curve, limits: MotionLimits = ARM.limits.motion) -> tuple[TimedTrajectory, float]:
    """The track along a curve and the lower bound of its duration."""
    found, candidate = on_a_branch(curve)
    path, squared_rates = time_tool_path(found, candidate, limits, rate=RATE)
    return time_joint_path(path, squared_rates, limits), duration_lower_bound(found, candidate, limits)


@pytest.mark.parametrize("seed", range(6))
def test_setpoints_keep_the_limits_with_the_reserve_at_any_phase_and_override(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track, _ = fastest(wandering(seed))
    for _ in range(20):
        setpoints = track.setpoints(RATE, phase=rng.uniform(), override=rng.choice([1.0, rng.uniform(0.05, 1.0)]))
        assert Margins().time_stretch(setpoints, ARM.limits.motion, RATE) <= 1.002
        assert max(use.max() for use in limit_uses(setpoints, ARM.limits.motion, RATE)) <= 1.0
    assert Margins().time_stretch(track.setpoints(RATE), ARM.limits.motion, RATE) > 0.99


def test_the_reserve_is_against_the_way_a_joint_turns_and_larger_when_it_turns_fast() -> None:
    t = np.arange(0.0, 0.032, 1 / RATE)[:, None]

    def turning(speed: float, acceleration: float) -> float:
        joints = (speed * t + acceleration * t**2 / 2) * np.array([1.0, 0, 0, 0, 0, 0])
        return Margins().time_stretch(joints, ARM.limits.motion, RATE) ** 2

    a, slow, fast = ARM.limits.acceleration[0], 0.1 * ARM.limits.speed[0], 0.9 * ARM.limits.speed[0]
    assert turning(-slow, -a) == pytest.approx(1 / Margins().along[0])
    assert turning(3 * slow, -a) == pytest.approx(turning(-3 * slow, a))
    assert turning(fast, -a) > turning(3 * slow, -a) > 1 / Margins().against[0]


def test_a_kink_of_acceleration_and_the_reserve_cost_little() -> None:
    found, candidate = on_a_branch(way(MIDDLE).curve)
    kept, used = (
        time_joint_path(
            *time_tool_path(found, candidate, ARM.limits.motion, rate=RATE, margins=reserve), ARM.limits.motion
        ).duration
        for reserve in (Margins(), NO_MARGINS)
    )
    assert used < kept < 1.03 * used


@pytest.mark.parametrize(("x", "ratio"), [(NEAR_X, 1.16), (MIDDLE, 1.26), (FAR_X, 1.28)])
def test_the_ways_of_the_paper_take_little_longer_than_without_jerk_limit_and_reserve(x: float, ratio: float) -> None:
    track, bound = fastest(way(x, degree=5).curve)
    assert bound < track.duration < ratio * bound


def test_a_sharp_bend_slows_only_itself() -> None:
    found, candidate = on_a_branch(hooked())
    path, squared_rates = time_tool_path(found, candidate, ARM.limits.motion, rate=RATE)
    track = time_joint_path(path, squared_rates, ARM.limits.motion)
    # No constant box of limits for the length runs faster than the steepest place allows everywhere.
    by_length = JointPath(found.lengths, found.lengths, candidate.joints)
    first, second, third = (np.abs(by_length(by_length.dense_parameters(), k)[:, :6]).max(axis=0) for k in (1, 2, 3))
    box = 1 / max(
        (first / ARM.limits.speed).max(),
        np.sqrt(second / ARM.limits.acceleration).max(),
        np.cbrt(third / ARM.limits.jerk).max(),
    )
    assert track.duration < 0.2 * found.lengths[-1] / box


@pytest.mark.parametrize("curve", [way(MIDDLE).curve, way(FAR_X, degree=5).curve, hooked()])
def test_the_tool_stays_on_the_curve(curve: Curve) -> None:
    found, candidate = on_a_branch(curve)
    path, squared_rates = time_tool_path(found, candidate, ARM.limits.motion, rate=RATE)
    setpoints = time_joint_path(path, squared_rates, ARM.limits.motion).setpoints(RATE, phase=0.3)
    wanted = found.curve(found.arc.parameters(setpoints[:, 6]))
    assert np.linalg.norm(tool_pose(setpoints[:, :6], ARM)[:, :3, 3] - wanted, axis=1).max() < 1e-5


def test_a_smaller_share_of_the_limits_takes_longer() -> None:
    durations = [fastest(way(MIDDLE).curve, ARM.limits.motion.scaled(s, s, s))[0].duration for s in (0.2, 0.5, 1.0)]
    assert durations == sorted(durations, reverse=True)


def test_a_track_is_the_integral_of_its_derivatives() -> None:
    track, _ = fastest(way(MIDDLE, degree=5).curve)
    for order in (0, 1, 2):
        slopes = track.table[:, order + 1, :6]
        integral = np.concatenate([np.zeros((1, 6)), np.cumsum((slopes[1:] + slopes[:-1]) / 2 * track.step, axis=0)])
        gained = track.table[:, order, :6] - track.table[0, order, :6]
        # Where jerk jumps from limit to limit, a trapezoid is wrong by half a step of the jump.
        jumps = ARM.limits.jerk * track.step if order == 2 else 0.0
        assert np.all(np.abs(integral - gained) <= 2e-3 * np.abs(gained).max() + jumps)
    np.testing.assert_allclose(track.table[[0, -1], 1:3, :6], 0.0, atol=0.02)


def line(turn: float) -> JointPath:
    """One joint's straight line, its parameter growing with the cube of time at both ends."""
    sigma = np.linspace(0.0, 1.0, 201)
    share = sigma**3 * (10 - 15 * sigma + 6 * sigma**2)
    return JointPath(sigma, share, share[:, None] * np.array([turn, 0, 0, 0, 0, 0]))


@pytest.mark.parametrize("turn", [0.02, 0.3, 2.0])
def test_one_joint_alone_takes_hardly_longer_than_its_closed_form(turn: float) -> None:
    # Rest to rest under limits of speed, acceleration and jerk (Biagiotti & Melchiorri 2008, section 3.4).
    v, a, j = (
        ARM.limits.speed[0],
        min(ARM.limits.acceleration[0], np.sqrt(ARM.limits.speed[0] * ARM.limits.jerk[0])),
        ARM.limits.jerk[0],
    )
    if turn >= v * (v / a + a / j):
        shortest = turn / v + v / a + a / j
    elif turn >= 2 * a**3 / j**2:
        shortest = a / j + np.sqrt((a / j) ** 2 + 4 * turn / a)
    else:
        shortest = 4 * np.cbrt(turn / (2 * j))
    path = line(turn)
    duration = time_joint_path(
        path, minimize_duration(path, ARM.limits.motion, 100, NO_MARGINS, arm=ARM), ARM.limits.motion
    ).duration
    assert 0.999 * shortest < duration < 1.04 * shortest


@pytest.mark.parametrize("turn", [0.02, 0.3, 2.0])
def test_the_lower_bound_of_a_line_is_the_trapezoid(turn: float) -> None:
    grid = np.linspace(0.0, 1.0, 4001)
    first = np.tile([turn, 0, 0, 0, 0, 0], (len(grid), 1))
    squares = max_squared_rates(
        grid, first, 0 * first, ARM.limits.speed, ARM.limits.acceleration, np.full(len(grid), np.inf)
    )
    v, a = min(ARM.limits.speed[0], np.sqrt(turn * ARM.limits.acceleration[0])), ARM.limits.acceleration[0]
    assert reach_times(grid, squares)[-1] == pytest.approx(turn / v + v / a, rel=2e-3)


def test_a_path_of_few_millimetres_can_be_timed() -> None:
    start = way(MIDDLE).curve.control_points[0] + [0.0, 0.0, 0.1]
    track, bound = fastest(clamped(start + np.linspace(0, 1, 6)[:, None] * [0.0, 0.012, 0.0], degree=5))
    assert bound < track.duration < 1.0
