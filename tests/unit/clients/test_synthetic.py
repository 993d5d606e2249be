import itertools
import math

import numpy as np
import pytest

from teachpath.motion.collision.builtin_scenes import TABLE_HEIGHT, paper_scene
from teachpath_client import synthetic
from teachpath_client.reading import HandReading
from teachpath_client.synthetic import GOAL, HAND_ABOVE, RATE, ROUTES, START, experiment_1, experiment_2

SCENE = paper_scene()
SEEDS = range(1, 6)


def closures(readings: list[HandReading]) -> np.ndarray:
    return np.array([np.mean(r.flexions) for r in readings])


def carries(readings: list[HandReading]) -> list[np.ndarray]:
    """Return the hand's positions while it is closed, one array a demonstration."""
    closed = closures(readings) > 0.5
    runs = itertools.groupby(zip(closed, readings, strict=True), key=lambda pair: pair[0])
    return [np.array([r.position for _, r in run]) for is_closed, run in runs if is_closed]


def test_the_same_seed_gives_the_same_stream() -> None:
    assert list(experiment_1(3)) == list(experiment_1(3))
    assert list(experiment_1(3)) != list(experiment_1(4))
    assert list(experiment_2(3)) == list(experiment_2(3))


@pytest.mark.parametrize(("experiment", "count"), [(experiment_1, 12), (experiment_2, 5)])
def test_an_experiment_has_its_demonstrations_and_each_grasps_only_at_the_object(
    experiment: object, count: int
) -> None:
    ways = carries(list(experiment(1)))  # type: ignore[operator]
    assert len(ways) == count
    for way in ways:
        assert np.linalg.norm(way[0] - HAND_ABOVE - START) < 0.01
        assert np.linalg.norm(way[-1] - HAND_ABOVE - GOAL) < 0.01


def test_the_first_experiment_shows_three_ways_in_the_papers_order() -> None:
    ways = carries(list(experiment_1(1)))
    middles = [way[np.argmin(np.abs(way[:, 1]))][0] for way in ways]
    nearest = [min(ROUTES, key=lambda name, x=x: abs(ROUTES[name][0] - x)) for x in middles]
    assert tuple(nearest) == synthetic.EXPERIMENT_1
    assert sorted(nearest.count(name) for name in ROUTES) == [3, 4, 5]


def test_a_reading_is_what_a_glove_and_a_tracker_give() -> None:
    readings = list(experiment_1(1))
    assert [r.time for r in readings] == [i / RATE for i in range(len(readings))]
    assert RATE == 50.0
    for reading in readings:
        assert len(reading.flexions) == 22
        assert all(0.0 <= f <= 1.0 for f in reading.flexions)
        assert reading.tracked
        assert reading.orientation is not None
        assert math.hypot(*reading.orientation) == pytest.approx(1.0, abs=1e-12)


def test_the_hand_opens_wide_and_closes_firmly() -> None:
    closure = closures(list(experiment_1(1)))
    assert closure.min() < 0.2
    assert closure.max() > 0.8
    # the service's thresholds are crossed once each way a demonstration
    assert np.sum(np.diff((closure > 0.6).astype(int)) == 1) == 12
    assert np.sum(np.diff((closure < 0.4).astype(int)) == 1) == 12


def test_the_hand_moves_as_a_hand_does() -> None:
    positions = np.array([r.position for r in experiment_1(1)])
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=1) * RATE
    assert speeds.max() < 2.0  # m/s
    assert positions[:, 2].min() > TABLE_HEIGHT


def gap(points: np.ndarray, name: str) -> float:
    """Return the least distance [m] of points (n, 3) from an obstacle of the scene."""
    shape = next(s for s in SCENE.obstacles if s.name == name)
    offset = np.abs(points - np.array(shape.position))
    if shape.kind == "box":
        beyond = offset - np.array(shape.size) / 2
    else:
        radial = np.hypot(offset[:, 0], offset[:, 1]) - shape.size[0]
        beyond = np.column_stack([radial, offset[:, 2] - shape.size[1] / 2])
    return float(np.min(np.linalg.norm(np.maximum(beyond, 0.0), axis=1)))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_ways_stay_clear_of_the_obstacles_by_the_carried_blocks_half_width(seed: int) -> None:
    assert SCENE.carried is not None
    half = SCENE.carried.size[0] / 2
    for way in carries(list(experiment_1(seed))):
        centres = way - HAND_ABOVE
        for name in ("box", "cylinder"):
            assert gap(centres, name) >= half, (seed, name)


def test_the_fifth_demonstration_of_the_second_experiment_wiggles() -> None:
    def roughness(way: np.ndarray) -> float:
        smooth = np.column_stack([np.convolve(way[:, i], np.ones(25) / 25, mode="valid") for i in range(3)])
        return float(np.sqrt(np.mean((way[12:-12] - smooth) ** 2)))

    *steady, shaky = (roughness(way) for way in carries(list(experiment_2(1))))
    assert shaky > 3 * max(steady)
