"""Metrics and probes: what is counted is told, the dashboard asks for all of it, and a station says if it is ready."""

import json
import re
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families
from websockets.sync.client import connect

from teachpath.io.wire import encode_sample
from teachpath.records import RecordingRequest, StopRequest
from tests.contract.desk import Desk, refused
from tests.unit.recording.hands import sample
from tests.waiting import wait_until

DASHBOARD = Path(__file__).parents[2] / "deploy" / "grafana-dashboard.json"


def exported(desk: Desk) -> dict[str, dict[str, float]]:
    """Return the values of every metric by its name, each by its labels in the order that they come."""
    answer = desk.send("GET", "/metrics")
    assert answer.status_code == 200
    found: dict[str, dict[str, float]] = {}
    for family in text_string_to_metric_families(answer.text):
        for one in family.samples:
            found.setdefault(one.name, {})[" ".join(one.labels.values())] = one.value
    return found


def test_the_dashboard_asks_for_every_metric_and_for_nothing_else(desk: Desk) -> None:
    desk.get("/tasks")
    targets = [target["expr"] for panel in json.loads(DASHBOARD.read_text())["panels"] for target in panel["targets"]]
    asked = {name for expression in targets for name in re.findall(r"teachpath_\w+", expression)}
    families = text_string_to_metric_families(desk.send("GET", "/metrics").text)
    given = {f"{family.name}_total" if family.type == "counter" else family.name for family in families}
    given = {name for name in given if not name.endswith("_created")}
    assert asked == given


def test_samples_and_their_losses_are_counted_over_all_recordings(desk: Desk) -> None:
    recorder, bus, keys = desk.station.recorder, desk.station.bus, desk.station.keys
    before = exported(desk)
    for _ in range(2):
        recorder.begin(RecordingRequest("counted", "counted-glove", scene="empty"))
        for number in (1, 2, 4, 4):
            bus.publish(keys.samples("counted-glove"), encode_sample(sample(number, (0.0, 0.0, 0.0))))
        wait_until(lambda: recorder.statuses(with_statistics=True)[0].statistics.received == 4, "they have come")  # type: ignore[union-attr]
        running = exported(desk)
        recorder.end(StopRequest("counted-glove"))
        assert exported(desk)["teachpath_samples_total"] == running["teachpath_samples_total"]
    after = exported(desk)
    assert after["teachpath_samples_total"][""] == before["teachpath_samples_total"][""] + 8
    for kind, count in (("lost", 2), ("duplicated", 2), ("refused", 0)):
        losses = [at["teachpath_sample_losses_total"][kind] for at in (before, after)]
        assert losses[1] == losses[0] + count, kind


def test_requests_and_open_sockets_are_counted(desk: Desk, port: int) -> None:
    before = exported(desk)
    desk.get("/tasks/moon")
    with connect(f"ws://127.0.0.1:{port}/api/v1/events") as socket:
        socket.recv()
        assert exported(desk)["teachpath_open_sockets"]["events"] == before["teachpath_open_sockets"]["events"] + 1
    after = exported(desk)
    assert after["teachpath_requests_total"]["GET 404"] == before["teachpath_requests_total"].get("GET 404", 0) + 1


def test_a_station_without_an_executor_lives_and_is_not_ready(desk: Desk) -> None:
    assert desk.get("/health/live").status_code == 200
    refused(desk.get("/health/ready"), 503, "the executor has said nothing for over a second")


@pytest.mark.parametrize("host", ["elsewhere.example", "127.0.0.1.example"])
def test_metrics_are_for_this_machine_as_all_else_is(desk: Desk, host: str) -> None:
    assert desk.send("GET", "/metrics", headers={"host": host}).status_code == 400
