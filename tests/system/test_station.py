"""A running service as its users meet it: trackers over Zenoh, programs over REST, operators at the command line."""

import csv
import io
import itertools
import math
import threading
from collections.abc import Iterable
from pathlib import Path

import httpx
import numpy as np
import pytest
from mcap.reader import make_reader
from websockets.sync.client import connect

from teachpath_client import ClientError, HandReading, Link, Tracker
from teachpath_client.errors import JobFailed
from teachpath_client.synthetic import experiment_1
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.system.processes import Service, run
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

KEYS = Keys()
SAMPLE_COUNT = 353  # samples that the synthetic hand needs for one demonstration
FAST_RATE = 50.0


def shown(count: int) -> Iterable[HandReading]:
    """Return the readings of the first `count` demonstrations of the paper's experiment."""
    return itertools.islice(experiment_1(), count * SAMPLE_COUNT)


def record(service: Service, task: str, count: int, *, speed: float = FAST_RATE) -> tracker_pb2.RecordingReport:
    with Link(service.endpoint) as link:
        tracker = Tracker(link, f"glove-{task}")
        tracker.start(task, scene="paper")
        tracker.publish(shown(count), speed=speed)
        return tracker.stop()


def trajectory(service: Service, demonstration: str) -> tuple[np.ndarray, np.ndarray]:
    found = service.station.trajectory(demonstration)
    return np.array(found.times), np.array(found.positions)


def write_csv(file: Path, *, rows: int = 100, text: str = "") -> Path:
    """Write a motion of 2 s over 0.4 m, or `text`."""
    content = io.StringIO()
    writer = csv.writer(content)
    writer.writerow(["t", "x", "y", "z"])
    writer.writerows([0.02 * i, 0.4 + 0.004 * i, 0.1 * math.sin(0.03 * i), 0.5] for i in range(rows))
    file.write_text(text or content.getvalue())
    return file


def test_a_take_over_zenoh_can_be_read_by_others_and_replayed(service: Service, tmp_path: Path) -> None:
    report = record(service, "carry", 2)
    assert (report.received, report.lost, report.refused) == (2 * SAMPLE_COUNT, 0, 0)
    stored = service.station.demonstrations("carry")
    assert [d.id for d in stored] == list(report.demonstrations)
    assert [d.verdict for d in stored] == ["clean", "clean"]

    sent = iter(shown(2))
    for demonstration in stored:
        content = service.station.recorded_demonstration(demonstration.id)
        messages = [
            tracker_pb2.HandSample.FromString(message.data)
            for _, _, message in make_reader(io.BytesIO(content)).iter_messages(topics=["samples"])
        ]
        assert len(messages) == demonstration.samples
        for message, reading in zip(messages, sent, strict=False):
            p = message.position
            assert (p.x, p.y, p.z) == reading.position

    again = run("replay", "carry", "--url", service.url, "--speed", str(FAST_RATE), folder=tmp_path)
    assert again.process.returncode == 0, again.err
    replayed = service.station.demonstrations("carry-replayed")
    assert [d.verdict for d in replayed] == ["clean", "clean"]
    for one, other in zip(stored, replayed, strict=True):
        (t, p), (s, q) = trajectory(service, one.id), trajectory(service, other.id)
        np.testing.assert_allclose(q, p, rtol=0, atol=1e-9)
        np.testing.assert_allclose(s, t, rtol=0, atol=1e-6)


def test_rubbish_during_a_take_is_counted_and_harms_nothing(service: Service) -> None:
    readings = list(shown(1))
    bad = [
        b"\xff rubbish",
        readings[100].message(101, 1).SerializeToString()[:-3],
        HandReading(1.0, (math.nan, 0.0, 0.0)).message(5, 1).SerializeToString(),
        HandReading(1.0, (0.0, math.inf, 0.0)).message(5, 1).SerializeToString(),
        HandReading(1.0, (0.0, 0.0, 0.0), (0.9, 0.9, 0.0, 0.0)).message(5, 1).SerializeToString(),
        bytes(10 * 1024 * 1024),
    ]
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove-rubbish")
        tracker.start("rubbish", scene="paper")
        tracker.publish(readings[:120], speed=FAST_RATE)
        publisher = link.publisher(KEYS.samples("glove-rubbish"))
        for payload in bad:
            publisher.put(payload)
        publisher.put(readings[10].message(11, 1).SerializeToString())  # a number that went back, at another time
        tracker.publish(readings[120:], speed=FAST_RATE)
        report = tracker.stop()
    assert (report.received, report.refused, report.conflicts, report.lost) == (SAMPLE_COUNT + 1, len(bad), 1, 0)
    assert any("not finite" in note for note in report.notes)
    assert any("10485760 bytes" in note for note in report.notes)
    (demonstration,) = service.station.demonstrations("rubbish")
    assert demonstration.verdict == "repaired"
    assert len(trajectory(service, demonstration.id)[0]) > 150
    assert service.station.health().notes == []


@pytest.mark.parametrize("name", ["a/b", "..", "../etc", "a..b", "x" * 65])
def test_names_that_could_leave_the_folder_are_refused(service: Service, name: str) -> None:
    before = sorted(service.data.rglob("*"))
    with Link(service.endpoint) as link, pytest.raises(ClientError, match="cannot name a task"):
        Tracker(link, "glove-names").start(name, scene="paper")
    with httpx.Client(base_url=service.url, timeout=HANG, trust_env=False) as http:
        answer = http.put(f"/api/v1/tasks/{name.replace('/', '%2F').replace('..', '%2E%2E')}", json={})
    assert answer.status_code in (404, 405, 422)
    assert not [path for path in sorted(service.data.rglob("*")) if path not in before and path.is_dir()]
    assert not [task for task in service.station.tasks() if task.name == name]


def test_a_flood_and_a_page_that_does_not_read_do_not_starve_a_take(service: Service) -> None:
    noise = HandReading(0.0, (0.4, 0.0, 0.6), (1.0, 0.0, 0.0, 0.0), (0.1,) * 22).message(1, 1).SerializeToString()
    over = threading.Event()
    sent = itertools.count()

    def flood() -> None:
        with Link(service.endpoint) as link:
            publisher = link.publisher(KEYS.samples("flood"))
            while not over.wait(0.01):
                for _ in range(40):
                    publisher.put(noise)
                    next(sent)

    flooding = threading.Thread(target=flood)
    with connect(f"ws://{service.url.removeprefix('http://')}/api/v1/view", max_queue=1, close_timeout=0.1):
        flooding.start()
        try:
            wait_until(lambda: next(sent) > 200, "the flood runs")
            report = record(service, "flooded", 2, speed=8.0)
            assert service.station.health().notes == []
        finally:
            over.set()
            flooding.join()
    assert next(sent) > 2 * SAMPLE_COUNT
    assert (report.received, report.lost, len(report.demonstrations)) == (2 * SAMPLE_COUNT, 0, 2)
    assert [d.verdict for d in service.station.demonstrations("flooded")] == ["clean", "clean"]


def test_files_are_imported_while_the_service_is_up(service: Service, tmp_path: Path) -> None:
    whole = write_csv(tmp_path / "whole.csv")
    first = run("import", "files", str(whole), "--data", str(service.data), folder=tmp_path)
    assert first.process.returncode == 0, first.err
    assert [d.number for d in service.station.import_file("files", whole.read_bytes())] == [2]
    assert [d.number for d in service.station.demonstrations("files")] == [1, 2]
    one, other = (trajectory(service, d.id) for d in service.station.demonstrations("files"))
    np.testing.assert_array_equal(one[1], other[1])


def test_a_data_folder_serves_one_service_only(service: Service, tmp_path: Path) -> None:
    second = Service(service.data)
    try:
        assert second.wait() == 1
    finally:
        second.clean_up()
    assert f"a teachpath service is using {service.data}" in second.err
    assert "Traceback" not in second.err
    doctor = run("doctor", "--data", str(service.data), folder=tmp_path)
    assert doctor.process.returncode == 1
    assert "stop it first" in doctor.err
    assert service.station.health().notes == []


def test_a_taken_endpoint_is_said(service: Service, tmp_path: Path) -> None:
    second = Service(tmp_path / "data", TEACHPATH_BUS__ENDPOINT=service.endpoint)
    try:
        assert second.wait() == 1
    finally:
        second.clean_up()
    assert f"no Zenoh session at {service.endpoint}: is it taken by another service?" in second.err
    assert "Traceback" not in second.err


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param(" ", "there are no samples in it", id="blank"),
        pytest.param("t,x,y,z\n", "no samples under the header", id="header only"),
        pytest.param("t,x,y,z\n0,0,0,0\n0.02,0.1", "line 3: 2 values", id="cut off"),
        pytest.param("t,x,y,z\n0,0.1,0,0\n0.02,nan,0,0\n", "1 of its 2 samples are tracked", id="not a number"),
        pytest.param("t,x,y,z\n0,0.1,0,0\n0.02,0.2,0,0\n", "2 samples are under the least", id="too short"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_and_nothing_stored(
    service: Service, text: str, sentence: str, tmp_path: Path
) -> None:
    file = write_csv(tmp_path / "broken.csv", text=text)
    with pytest.raises(JobFailed) as failed:
        service.station.import_file("broken", file.read_bytes(), name="broken.csv")
    assert sentence in failed.value.job.message
    known = {task.name for task in service.station.tasks()}
    assert "broken" not in known or service.station.demonstrations("broken") == []
    assert not list(service.data.rglob("*.part"))
