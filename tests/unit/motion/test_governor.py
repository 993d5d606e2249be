import re
from pathlib import Path

import numpy as np
import pytest
import ruckig

import teachpath.motion
from teachpath.motion.governor import Governor
from teachpath.motion.timing import Limits, rest_to_rest, to_position, to_speed

BOX = Limits(0.6, 1.5, 10.0)
DT = 0.004


def differences(lengths: list[float]) -> list[float]:
    padded = np.array([lengths[0]] * 3 + lengths + [lengths[-1]] * 3)
    return [float(np.abs(np.diff(padded, k)).max()) / DT**k for k in (1, 2, 3)]


@pytest.mark.parametrize("seed", range(60))
def test_no_sequence_of_commands_breaks_a_limit_or_goes_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    governor = Governor(1.0, BOX, override=rng.uniform(0.05, 1.0))
    lengths, until = [0.0], 0
    commands = (
        lambda: governor.set_override(rng.uniform()),
        lambda: governor.set_override(1.0),
        governor.hold,
        governor.resume,
    )
    while not governor.progress.finished:
        if len(lengths) >= until:
            commands[rng.integers(4)]()
            until += int(rng.integers(1, 100 if seed % 2 else 8))
        if len(lengths) > 1500:
            governor.set_override(1.0)
            governor.resume()
        lengths.append(governor.step(DT).s)
        assert len(lengths) < 2500
    assert np.diff(lengths).min() > -1e-9
    assert lengths[-1] == pytest.approx(1.0, abs=1e-7)
    for measured, limit in zip(differences(lengths), (BOX.velocity, BOX.acceleration, BOX.jerk), strict=True):
        assert measured <= limit * (1 + 1e-6)


def test_undisturbed_it_takes_the_shortest_time() -> None:
    governor, cycles = Governor(1.0, BOX), 0
    while not governor.progress.finished:
        governor.step(DT)
        cycles += 1
    assert (cycles - 1) * DT <= rest_to_rest(1.0, BOX) <= cycles * DT


@pytest.mark.parametrize("length", [1e-3, 0.02, 0.3, 2.0])
def test_the_closed_form_of_the_duration_is_ruckigs(length: float) -> None:
    answer = to_position((0.0, 0.0, 0.0), length, BOX, BOX.velocity)
    assert answer is not None
    assert rest_to_rest(length, BOX) == pytest.approx(answer.duration, rel=1e-9)


def test_an_override_scales_the_speed() -> None:
    governor = Governor(1.0, BOX, override=0.25)
    speeds = [governor.step(DT).speed for _ in range(500)]
    assert max(speeds) == pytest.approx(0.25 * BOX.velocity)


def test_hold_comes_to_rest_and_stays_until_resumed() -> None:
    governor = Governor(1.0, BOX)
    for _ in range(200):
        governor.step(DT)
    governor.hold()
    stopping = governor.step(DT)
    assert not stopping.standing
    for _ in range(300):
        governor.step(DT)
    held = governor.progress
    assert held.standing
    assert not held.finished
    assert governor.step(DT).s == held.s
    governor.resume()
    for _ in range(1000):
        governor.step(DT)
    assert governor.progress.finished


def test_an_override_of_zero_or_nan_holds() -> None:
    for share in (0.0, float("nan"), -1.0):
        governor = Governor(1.0, BOX)
        for _ in range(100):
            governor.step(DT)
        governor.set_override(share)
        for _ in range(300):
            governor.step(DT)
        assert governor.progress.standing
        assert governor.held


def test_ruckig_is_never_given_waypoints() -> None:
    # With waypoints the ruckig wheel posts the problem to a network service.
    room = Path(teachpath.motion.__file__).parent
    named = [file.name for file in room.glob("*.py") if re.search("intermediate_positions", file.read_text())]
    assert not named
    assert ruckig.InputParameter(1).intermediate_positions == []


def test_unsolvable_problems_have_no_answer() -> None:
    assert to_position((float("nan"), 0.0, 0.0), 1.0, BOX, BOX.velocity) is None
    assert to_speed((0.0, float("inf"), 0.0), BOX, 0.0) is None
