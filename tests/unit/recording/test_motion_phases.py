"""Taking and putting found in the motion of a hand, on generated motions: reach, carry, return."""

import numpy as np
import pytest

from teachpath.recording.motion_phases import MotionPhases, PhaseEvidence, find_motion_phases
from teachpath.records import Array

RATE = 100.0  # [Hz]
FAR_DISTANCE = 0.05  # [m] from the true place; nothing that is called sure may lie farther
SEEDS = range(12)
Motion = tuple[Array, Array]  # positions (n, 3) [m], and the true places (2, 3)


def minimum_jerk(a: Array, b: Array, seconds: float, bow: float = 0.0) -> Array:
    s = np.linspace(0.0, 1.0, round(RATE * seconds))[:, None]
    return a + (b - a) * (10 * s**3 - 15 * s**4 + 6 * s**5) + np.array([0.0, 0.0, bow]) * np.sin(np.pi * s) ** 2


def pick_and_place(rng: np.random.Generator, *, dwell: float = 0.15, pause: float = 0.0) -> Motion:
    """Return a hand that comes in motion, takes, carries, puts and leaves in motion."""
    corners = np.array([[0.0, 0.0, 0.5], [-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]])
    start, take, put, leave = corners + rng.uniform([-0.3, -0.4, 0.2], [0.3, 0.4, 0.3], (4, 3))
    reach = minimum_jerk(start, take, 1.2)[40:]
    middle = (take + put) / 2 + [0, 0, 0.1]
    carry = (
        [
            minimum_jerk(take, middle, 0.8),
            np.repeat([middle], round(RATE * pause), axis=0),
            minimum_jerk(middle, put, 0.8),
        ]
        if pause
        else [minimum_jerk(take, put, 1.5, bow=0.15)]
    )
    rests = [np.repeat([place], round(RATE * dwell), axis=0) for place in (take, put)]
    back = minimum_jerk(put, leave, 1.2)[:-40]
    shown = np.concatenate([reach, rests[0], *carry, rests[1], back])
    return shown + rng.normal(0, 0.0003, shown.shape), np.array([take, put])


def found(positions: Array) -> MotionPhases:
    return find_motion_phases(np.arange(len(positions)) / RATE, positions)


def spiked(positions: Array, rng: np.random.Generator) -> Array:
    changed = positions.copy()
    changed[rng.choice(len(positions), 5, replace=False)] += rng.normal(0, 0.2, (5, 3))
    return changed


CHANGES = {
    "nothing": lambda p, rng: p,
    "noise of 10 mm": lambda p, rng: p + rng.normal(0, 0.01, p.shape),
    "doubled readings": lambda p, rng: np.repeat(p[::2], 2, axis=0),
    "every 4th reading": lambda p, rng: p[::4],
    "spikes": spiked,
    "another frame and unit": lambda p, rng: 1000.0 * p[:, [2, 0, 1]] * [1, -1, 1] + 7000.0,
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_called_sure_is_near_the_true_places(change: str) -> None:
    sure = 0
    for seed in SEEDS:
        rng = np.random.default_rng([seed, 3])
        positions, places = pick_and_place(rng)
        changed = found(CHANGES[change](positions, rng))
        if changed.evidence is not PhaseEvidence.DWELLS:
            continue
        sure += 1
        if change != "another frame and unit":
            assert np.linalg.norm(changed.places - places, axis=1).max() < FAR_DISTANCE
        else:
            plain = found(positions)
            assert (changed.grasp, changed.release) == (plain.grasp, plain.release)
    assert sure >= 0.75 * len(SEEDS)


def test_the_readings_chosen_are_those_at_the_places() -> None:
    for seed in SEEDS:
        positions, places = pick_and_place(np.random.default_rng([seed, 3]))
        phases = found(positions)
        at = positions[[phases.grasp, phases.release - 1]]
        assert np.linalg.norm(at - places, axis=1).max() < FAR_DISTANCE


@pytest.mark.parametrize("dwell", [0.05, 0.4, 3.0])
def test_a_rest_at_a_place_is_one_dwell_however_long(dwell: float) -> None:
    for seed in SEEDS:
        positions, places = pick_and_place(np.random.default_rng([seed, 5]), dwell=dwell)
        phases = found(positions)
        assert phases.evidence is PhaseEvidence.DWELLS
        assert np.linalg.norm(phases.places - places, axis=1).max() < FAR_DISTANCE


@pytest.mark.parametrize("pause", [0.3, 1.0])
def test_a_pause_on_the_way_leaves_it_unsure_and_names_the_pauses(pause: float) -> None:
    for seed in SEEDS:
        phases = found(pick_and_place(np.random.default_rng([seed, 7]), pause=pause)[0])
        assert phases.evidence is PhaseEvidence.UNSURE
        assert len(phases.dwell_times) == 3


def test_a_motion_with_one_place_is_unsure() -> None:
    for seed in SEEDS:
        positions, _ = pick_and_place(np.random.default_rng([seed, 9]))
        assert found(positions[: len(positions) // 2]).evidence is PhaseEvidence.UNSURE


def test_a_motion_without_a_dwell_is_the_transport_as_a_whole() -> None:
    positions = minimum_jerk(np.zeros(3), np.array([0.5, 0.2, 0.0]), 2.0, bow=0.2)
    rest = np.repeat(positions[:1], 100, axis=0)
    k = np.arange(120)
    bend = np.column_stack([0.002 * k, 0.1 * np.sin(k / 20), 0 * k])  # slows down to a third at its bends
    for whole in (bend, positions, np.concatenate([rest, positions]), positions[::-1], positions[:5], positions[:1]):
        phases = found(whole)
        assert (phases.evidence, phases.grasp, phases.release) == (PhaseEvidence.WHOLE, 0, len(whole))


def test_a_motionless_file_is_its_whole() -> None:
    assert found(np.ones((200, 3))).evidence is PhaseEvidence.WHOLE
