"""The whole story of a task that is shown with its object at changing places, until the arm takes it from a new one."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from teachpath_client import HandReading, Link, Tracker
from teachpath_client.synthetic import RATE
from tests.system.processes import Service, run
from tests.system.test_station import FAST_RATE, SAMPLE_COUNT, shown
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

TASK = "moved"
PLACES = ((0.0, 0.0), (-0.08, 0.05), (0.05, 0.08), (-0.05, -0.03))  # of object and goal beside the scene's [m]
GOALS = ((0.0, 0.0), (0.06, -0.1), (-0.1, 0.04), (0.02, 0.05))


def moved(
    readings: list[HandReading], number: int, place: tuple[float, float], goal: tuple[float, float]
) -> list[HandReading]:
    """Show it as the `number`-th, from another place to another goal beside the scene's [m]."""
    points = np.array([reading.position for reading in readings])
    share = np.clip((points[:, 1] + 0.28) / 0.56, 0.0, 1.0)[:, None]
    points[:, :2] += (1 - share) * place + share * np.array(goal)
    return [
        HandReading((number * SAMPLE_COUNT + k) / RATE, tuple(point), reading.orientation, reading.flexions)
        for k, (reading, point) in enumerate(zip(readings, points.tolist(), strict=True))
    ]


def has_come(service: Service, samples: int) -> bool:
    return service.station.recordings(TASK)[0].received >= samples


def test_a_task_is_shown_at_changing_places_and_done_at_a_new_one(service: Service, tmp_path: Path) -> None:
    station = service.station
    x, y, z = station.get_object("paper").position
    between = [
        list(shown(7))[k * SAMPLE_COUNT : (k + 1) * SAMPLE_COUNT] for k in (1, 4, 1, 4)
    ]  # of one way of the paper's
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove-moved")
        tracker.start(TASK, scene="paper")
        try:
            for number, readings in enumerate(between):
                place, goal = PLACES[number], GOALS[number]
                station.tell_object("paper", (x + place[0], y + place[1], z))
                tracker.publish(moved(readings, number, place, goal), speed=FAST_RATE)
                wait_until(partial(has_come, service, (number + 1) * SAMPLE_COUNT), "its samples are recorded")
        finally:
            station.reset_object("paper")
            report = tracker.stop()
    assert len(report.demonstrations) == len(PLACES), report.notes
    stored = station.demonstrations(TASK)
    for demonstration, place in zip(stored[1:], PLACES[1:], strict=True):
        assert demonstration.object_pose is not None
        np.testing.assert_allclose(demonstration.object_pose.position, (x + place[0], y + place[1], z), atol=1e-9)
        first = station.trajectory(demonstration.id).positions[0]
        np.testing.assert_allclose(first, demonstration.object_pose.position)

    learned = station.learn(TASK).learned
    (path,) = learned.paths
    assert learned.notes[0].startswith("a task with a moving start and goal: ")
    station.wait_for_arm(timeout=HANG)
    lies = (x - 0.03, y + 0.04, z)
    try:
        station.tell_object("paper", lies)
        command = run("run", path.id, "--adapt", "--url", service.url, folder=tmp_path)
        assert command.process.returncode == 0, command.err
        assert " ended: " in command.out
        carried = station.plans(path.id)[0].scene.carried
        assert carried is not None
        np.testing.assert_allclose(carried.position, lies)
    finally:
        station.reset_object("paper")
