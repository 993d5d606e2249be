"""A service that is stopped and started anew, or replaced by another, while a hand shows: no take is lost."""

import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from teachpath_client import HandReading, Link, Tracker
from teachpath_client.synthetic import experiment_1
from tests.system.processes import Service, run
from tests.system.test_station import trajectory, write_csv
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SAMPLE_COUNT = 353  # readings of the first demonstration; it carries from 83 to 256
STOP_SAMPLE, START_SAMPLE = 150, 200


def readings(at: dict[int, Callable[[], object]]) -> Iterator[HandReading]:
    """Yield one demonstration, and call something before some of its readings."""
    for number, reading in enumerate(itertools.islice(experiment_1(), SAMPLE_COUNT)):
        at.get(number, lambda: None)()
        yield reading


def import_files(data: Path, folder: Path) -> None:
    """Import a file while no service runs, and one that is not there."""
    file = write_csv(folder / "motion.csv")
    assert run("import", "files", str(file), "--data", str(data), folder=folder).process.returncode == 0
    torn = run("import", "files", str(folder / "none.csv"), "--data", str(data), folder=folder)
    assert torn.process.returncode == 1
    assert torn.err.startswith("teachpath: cannot read")


def test_a_planned_restart_in_mid_take_loses_nothing_nor_does_another_service_in_its_place(tmp_path: Path) -> None:
    first = Service(tmp_path / "data", TEACHPATH_SIMULATOR__START="false")
    second: list[Service] = []

    def stop() -> None:
        first.__exit__(None, None, None)
        import_files(first.data, tmp_path)

    def start() -> None:
        second.append(Service(first.data, ports=first.ports).__enter__())

    def replace() -> None:
        second.append(Service(first.data, ports=first.ports, arguments=("--standby",)))
        wait_until(lambda: "stands by" in second[1].out, "another service stands by")
        second[0].__exit__(None, None, None)
        second[1].__enter__()

    def is_back() -> None:
        there = lambda: "glove" in [t.name for t in second[-1].station.health().trackers if t.announced]  # noqa: E731
        wait_until(there, "the tracker is back")

    with first, Link(first.endpoint) as link:
        tracker = Tracker(link, "glove")
        tracker.start("carry", scene="paper")
        tracker.publish(readings({STOP_SAMPLE: stop, START_SAMPLE: start, SAMPLE_COUNT - 1: is_back}), speed=8.0)
        with second[0] as service:
            report = tracker.stop()
            assert (report.lost, len(report.demonstrations)) == (0, 1), report
            (made,) = service.station.demonstrations("carry")
            assert (made.verdict, made.statistics.lost) == ("clean", 0), made.reasons
            assert "the service was stopped in mid-take, and started anew" in made.statistics.notes
            tracker.start("whole", scene="paper")
            tracker.publish(readings({}), speed=8.0)
            tracker.stop()
            (whole,) = service.station.demonstrations("whole")
            for now, then in zip(trajectory(service, made.id), trajectory(service, whole.id), strict=True):
                np.testing.assert_allclose(now, then, atol=1e-6)
            tracker.start("replaced", scene="paper")
            tracker.publish(readings({STOP_SAMPLE: replace, SAMPLE_COUNT - 1: is_back}), speed=8.0)
        with second[1] as service:
            report = tracker.stop()
            assert (report.lost, len(report.demonstrations)) == (0, 1), report
            (replaced,) = service.station.demonstrations("replaced")
            for now, then in zip(trajectory(service, replaced.id), trajectory(service, whole.id), strict=True):
                np.testing.assert_allclose(now, then, atol=1e-6)
            assert service.station.health().notes == []
            (imported,) = service.station.demonstrations("files")
            assert len(trajectory(service, imported.id)[0]) == 100
