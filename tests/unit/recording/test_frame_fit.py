"""The laws of a tracker's frame: it is found again, its residuals are true, and points that fix none are refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableInput
from teachpath.recording.demonstration import to_world
from teachpath.recording.frame_fit import fit_frame
from teachpath.records import Array, Calibration, TaughtPoint

PLACES = np.array([[0.4, -0.3, 0.5], [0.7, -0.3, 0.5], [0.7, 0.3, 0.5], [0.4, 0.3, 0.5], [0.5, 0.0, 0.8]])


def frame(seed: int, scale: float = 1.0) -> Calibration:
    random = np.random.default_rng(seed)
    w, x, y, z = Rotation.random(rng=random).as_quat(scalar_first=True).tolist()
    a, b, c = random.uniform(-0.8, 0.8, 3).tolist()
    return Calibration("true", scale, (w, x, y, z), (a, b, c))


def seen(calibration: Calibration, world: Array) -> Array:
    """Return where the tracker sees places of the world: the inverse of `to_world`."""
    rotation = Rotation.from_quat(calibration.rotation, scalar_first=True)
    return np.asarray(rotation.inv().apply(world - np.array(calibration.offset)) / calibration.scale)


def taught(tracker: Array, world: Array) -> list[TaughtPoint]:
    return [TaughtPoint(tuple(t), tuple(w)) for t, w in zip(tracker.tolist(), world.tolist(), strict=True)]


def fitted(points: list[TaughtPoint], **options: bool) -> Calibration:
    return fit_frame("lab", points, largest_residual=0.02, **options).calibration


@given(seed=st.integers(0, 10_000), count=st.integers(3, 5), scale=st.sampled_from([1.0, 0.0254, 1.3]))
@settings(max_examples=60, deadline=None)
def test_the_frame_is_found_again_from_its_own_points(seed: int, count: int, scale: float) -> None:
    true = frame(seed, scale)
    found = fitted(taught(seen(true, PLACES[:count]), PLACES[:count]), fit_scale=scale != 1.0)
    probe = np.random.default_rng(seed).uniform(-1, 1, (20, 3)) / scale
    assert found.scale == pytest.approx(scale, rel=1e-9)
    assert np.allclose(to_world(found, probe), to_world(true, probe), atol=1e-9)
    assert found.rotation[0] >= 0.0


@pytest.mark.parametrize("seed", range(5))
def test_no_other_frame_near_it_fits_noisy_points_better(seed: int) -> None:
    random = np.random.default_rng(seed)
    tracker = seen(frame(seed), PLACES) + random.normal(0.0, 0.002, PLACES.shape)
    measured = fit_frame("lab", taught(tracker, PLACES), largest_residual=0.02)
    found = measured.calibration
    errors = np.linalg.norm(to_world(found, tracker) - PLACES, axis=1)
    assert [p.residual for p in measured.points] == pytest.approx(errors.tolist())
    assert measured.rms == pytest.approx(float(np.sqrt(np.mean(errors**2))))
    for _ in range(200):
        turn = Rotation.from_rotvec(random.normal(0.0, 1e-3, 3)) * Rotation.from_quat(found.rotation, scalar_first=True)
        w, x, y, z = turn.as_quat(scalar_first=True).tolist()
        a, b, c = (np.array(found.offset) + random.normal(0.0, 1e-3, 3)).tolist()
        other = Calibration("other", 1.0, (w, x, y, z), (a, b, c))
        assert np.sum((to_world(other, tracker) - PLACES) ** 2) >= np.sum(errors**2)


def test_too_few_points_and_points_on_one_line_are_refused() -> None:
    world = PLACES[:2]
    with pytest.raises(UnusableInput, match="2 points do not fix a frame; teach 3 or more"):
        fitted(taught(world, world))
    line = np.array([[0.1 * i, 0.2 * i, 0.001 * (i % 2)] for i in range(5)])
    with pytest.raises(UnusableInput, match=r"on one line in the world: they spread .* cm along it"):
        fitted(taught(line, line))
    with pytest.raises(UnusableInput, match="on one line for the tracker"):
        fitted(taught(line, PLACES))
    with pytest.raises(UnusableInput, match="on one line"):
        fitted(taught(np.zeros((4, 3)), np.zeros((4, 3))))


def test_points_that_contradict_are_refused_and_the_wrong_one_is_named() -> None:
    tracker = seen(frame(1), PLACES)
    tracker[3] += [0.1, 0.0, 0.0]
    with pytest.raises(UnusableInput, match="without point 4 they agree: teach that one again"):
        fitted(taught(tracker, PLACES))
    with pytest.raises(UnusableInput, match=r"contradict one another: point .* teach them again"):
        fitted(taught(tracker[[0, 1, 3]], PLACES[[0, 1, 3]] * [1.0, 1.2, 1.0]), fit_scale=True)


def test_wrong_units_and_a_mirrored_frame_are_named() -> None:
    with pytest.raises(UnusableInput, match=r"0\.0254 times as far apart .* another unit"):
        fitted(taught(seen(frame(2, 0.0254), PLACES), PLACES))
    with pytest.raises(UnusableInput, match="one axis of the tracker reversed"):
        fitted(taught(seen(frame(3), PLACES) * [1.0, -1.0, 1.0], PLACES))


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 101.0])
def test_a_point_that_is_no_place_is_named(bad: float) -> None:
    world = PLACES.copy()
    world[2, 1] = bad
    with pytest.raises(UnusableInput, match=r"point 3 lies at .* limit 100"):
        fitted(taught(PLACES, world))
