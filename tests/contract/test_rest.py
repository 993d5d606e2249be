"""The REST API of a station: what it answers, above all to what cannot be used. Never a status 500."""

import io
import json
import queue
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from httpx import Response
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from teachpath.app import Station
from teachpath.records import Job, JobState
from tests.contract import openapi, stations
from tests.unit.io.test_documents import a_plan

API = "/api/v1"


class Desk:
    """A station and a client that speaks to it."""

    def __init__(self, station: Station) -> None:
        self.station = station
        self.http = TestClient(station.web, base_url="http://127.0.0.1:8765", raise_server_exceptions=False)
        self._news: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        station.bus.subscribe(station.keys.job("*"), lambda _, payload: self._news.put(payload))

    def get(self, resource: str, **options: Any) -> Response:
        return self.http.get(API + resource, **options)

    def post(self, resource: str, body: Any = None, **options: Any) -> Response:
        return self.http.post(API + resource, json=body, **options)

    def import_(self, task: str, content: bytes | str, **query: Any) -> Response:
        return self.http.post(f"{API}/tasks/{task}/demonstrations", content=content, params=query)

    def ended(self, accepted: Response) -> dict[str, Any]:
        """Wait for the job that was accepted to end."""
        assert accepted.status_code == 202, accepted.text
        assert accepted.headers["location"] == f"{API}/jobs/{accepted.json()['id']}"
        while True:
            job: dict[str, Any] = self.http.get(accepted.headers["location"]).json()
            if job["finished_ns"]:
                return job
            self._news.get(timeout=60)


@pytest.fixture(scope="module")
def desk() -> Iterator[Desk]:
    with stations.station() as station:
        yield Desk(station)


def refused(response: Response, status: int, sentence: str) -> None:
    """Check that a refusal has its status and a sentence, on one line, that holds `sentence`."""
    assert response.status_code == status, response.text
    detail = response.json()["detail"]
    assert isinstance(detail, str)
    assert sentence in detail, detail
    assert len(detail) > 20
    assert "\n" not in detail


def csv(points: int = 60, *, step: float = 0.01) -> str:
    return "t,x,y,z\n" + "".join(f"{i * 0.02},{0.4 + step * i},{0.1 * np.sin(i / 20):.6f},0.6\n" for i in range(points))


def npy(values: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, values)
    return out.getvalue()


def planned(station: Station, key: str) -> str:
    """Store a plan and return its id."""
    job = Job(f"plan-{key}", "t", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0)
    station.store.add_job(job)
    return station.store.finish_planning(job.id, replace(a_plan(), id=key))


# what is not there


@pytest.mark.parametrize(
    ("method", "resource", "what"),
    [
        ("GET", "/tasks/moon", "task 'moon'"),
        ("GET", "/tasks/moon/demonstrations", "task 'moon'"),
        ("GET", "/tasks/moon/recording", "task 'moon'"),
        ("GET", "/tasks/moon/jobs", "task 'moon'"),
        ("GET", "/tasks/moon/runs", "task 'moon'"),
        ("GET", "/tasks/moon/runs/run-1", "run 'run-1'"),
        ("POST", "/tasks/moon/jobs", "task 'moon'"),
        ("POST", "/tasks/moon/recording", "task 'moon'"),
        ("POST", "/tasks/moon/recording/stop", "task 'moon'"),
        ("GET", "/demonstrations/moon", "demonstration 'moon'"),
        ("GET", "/demonstrations/moon/trajectory", "demonstration 'moon'"),
        ("GET", "/demonstrations/moon/recording", "demonstration 'moon'"),
        ("GET", "/jobs/moon", "job 'moon'"),
        ("POST", "/jobs/moon/cancel", "job 'moon'"),
        ("GET", "/paths/moon", "path 'moon'"),
        ("GET", "/paths/moon/plans", "path 'moon'"),
        ("POST", "/paths/moon/plans", "path 'moon'"),
        ("GET", "/plans/moon", "plan 'moon'"),
        ("POST", "/executions", "plan 'moon'"),
        ("GET", "/executions/moon", "execution 'moon'"),
        ("POST", "/executions/moon/override", "execution 'moon'"),
        ("POST", "/executions/moon/stop", "execution 'moon'"),
    ],
)
def test_what_is_not_there_is_404_and_named(desk: Desk, method: str, resource: str, what: str) -> None:
    body = {"tracker": "glove", "plan": "moon", "override": 0.5}
    answer = desk.http.request(method, API + resource, json=body if method == "POST" else None)
    refused(answer, 404, f"there is no {what}")


def test_a_wrong_address_and_a_wrong_method_say_where_to_look(desk: Desk) -> None:
    refused(desk.get("/nothing"), 404, "/docs")
    answer = desk.http.delete(f"{API}/tasks")
    refused(answer, 405, "allowed here: GET")
    assert answer.headers["allow"] == "GET"


@pytest.mark.parametrize("name", ["..", "a..b", "%2e%2e", "a%2Fb", "%00", "a%0Ab", "a b", "é", "-a", "x" * 65, "%ff"])
def test_a_bad_task_name_makes_nothing(desk: Desk, name: str) -> None:
    before = desk.get("/tasks").json()
    for answer in (desk.http.put(f"{API}/tasks/{name}", json={}), desk.import_(name, csv())):
        assert answer.status_code in (404, 405, 422), answer.text
        assert len(answer.json()["detail"]) > 20
    assert desk.get("/tasks").json() == before


def test_a_name_of_64_characters_is_one(desk: Desk) -> None:
    assert desk.http.put(f"{API}/tasks/{'x' * 64}", json={}).json()["scene"] == "paper"
    refused(desk.http.put(f"{API}/tasks/{'x' * 65}", json={}), 422, "at most 64")


def test_a_task_that_exists_stays_as_it_is(desk: Desk) -> None:
    made = desk.http.put(f"{API}/tasks/kept", json={"scene": "empty"}).json()
    assert desk.http.put(f"{API}/tasks/kept", json={"scene": "paper"}).json() == made
    refused(desk.http.put(f"{API}/tasks/new", json={"scene": "moon"}), 404, "no scene 'moon'; known: paper, empty")
    refused(desk.http.put(f"{API}/tasks/new", json={"calibration": "moon"}), 404, "no calibration 'moon'")
    assert desk.get("/tasks/new").status_code == 404


# bodies that cannot be used

BODIES = {
    b"": "body: Field required",
    b"{": "body: this is no JSON",
    b"[]": "body: it should be a valid dictionary or object",
    b"{}": "body.plan: Field required, and 0 more",
    b'{"plan": 3}': "body.plan: it should be a valid string",
    b'{"plan": "p", "override": NaN}': "body.override: it should be",
    b'{"plan": "p", "override": Infinity}': "body.override: it should be less than or equal to 1",
    b'{"plan": "p", "override": 2}': "body.override: it should be less than or equal to 1",
    b'{"plan": 1, "override": -1}': "and 1 more",
    b'{"plan": "\\ud800"}': "",
    b"\xff\xfe": "body",
    b"[" * 100_000: "body",
    b"1" * 10_000: "body",
}


@pytest.mark.parametrize("body", BODIES, ids=lambda b: b[:30])
def test_a_wrong_body_is_one_sentence_that_names_the_field(desk: Desk, body: bytes) -> None:
    answer = desk.http.post(f"{API}/executions", content=body, headers={"content-type": "application/json"})
    assert answer.status_code in (400, 422)
    refused(answer, answer.status_code, BODIES[body].replace(", and 0 more", ""))


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "x"])
def test_a_body_that_is_not_declared_as_json_is_refused(desk: Desk, kind: str) -> None:
    answer = desk.http.post(f"{API}/executions", content=b'{"plan": "p"}', headers={"content-type": kind})
    refused(answer, 422, "body")


def test_a_body_over_the_limit_is_413_whether_announced_or_not(desk: Desk) -> None:
    def chunks(size: int) -> Iterator[bytes]:
        for _ in range(0, size, 100_000):
            yield bytes(100_000)

    refused(desk.import_("huge", bytes(2_000_001)), 413, "2000001 bytes is over the limit of 2000000; split the file")
    refused(desk.import_("huge", chunks(2_100_000)), 413, "over the limit of 2000000")
    document = {"content-type": "application/json"}
    answer = desk.http.post(f"{API}/executions", content=chunks(1_200_000), headers=document)
    refused(answer, 413, "over the limit of 1048576")
    refused(desk.post("/executions", {"plan": "p" * 1_100_000}), 413, "over the limit of 1048576")
    assert desk.get("/tasks/huge").status_code == 404


# who may ask


def test_a_foreign_host_is_refused_and_a_named_one_is_not(desk: Desk) -> None:
    assert desk.get("/health", headers={"host": "evil.example"}).status_code == 400
    for host in ("localhost:8765", "127.0.0.1", "robot.example"):
        assert desk.get("/health", headers={"host": host}).status_code == 200


def test_a_page_of_another_origin_gives_no_orders(desk: Desk) -> None:
    ours, theirs = {"origin": "http://127.0.0.1:8765"}, {"origin": "http://evil.example"}
    refused(desk.post("/jobs/moon/cancel", headers=theirs), 403, "http://evil.example may not give orders")
    refused(desk.post("/jobs/moon/cancel", headers={"origin": "null"}), 403, "may not give orders")
    refused(desk.post("/jobs/moon/cancel", headers=ours), 404, "no job 'moon'")
    assert desk.get("/tasks", headers=theirs).headers.get("access-control-allow-origin") is None


# recording


def test_recording_starts_once_and_stops_with_an_account(desk: Desk) -> None:
    desk.http.put(f"{API}/tasks/lift", json={})
    begun = desk.post("/tasks/lift/recording", {"tracker": "glove"})
    assert begun.status_code == 201
    assert [r["tracker"] for r in desk.get("/tasks/lift/recording").json()] == ["glove"]
    refused(desk.post("/tasks/lift/recording", {"tracker": "glove"}), 409, "glove is already recording lift")
    refused(desk.post("/tasks/lift/recording/stop", {"tracker": "other"}), 422, "'other' is not recording lift")
    ended = desk.post("/tasks/lift/recording/stop", {"tracker": "glove"}).json()
    assert (int(ended["received"]), ended["demonstrations"]) == (0, [])
    refused(desk.post("/tasks/lift/recording/stop", {"tracker": "glove"}), 422, "running: none")
    assert desk.get("/tasks/lift/recording").json() == []


@pytest.mark.parametrize("tracker", ["", "a/b", "*", "..", "x" * 65, "a\n"])
def test_a_bad_tracker_name_is_refused(desk: Desk, tracker: str) -> None:
    desk.http.put(f"{API}/tasks/lift", json={})
    answer = desk.post("/tasks/lift/recording", {"tracker": tracker})
    refused(answer, 422, "cannot name a tracker")


# imports

LONG = "t,x,y,z\n" + "".join(f"{i * 0.02},{i},0,0\n" for i in range(10))


@pytest.mark.parametrize(
    ("content", "query", "sentence"),
    [
        ("", {}, "the file is empty"),
        ("t,x,y,z\n", {}, "no samples under the header"),
        ("a,b\n1,2\n", {}, "the first line must be t,x,y,z"),
        (csv()[:-8], {}, "line 61"),
        (csv() + "9,nan,0,0\n", {}, "sample 60 has a x that is not finite"),
        (csv() + "0,0,0,0\n", {}, "sort by t"),
        (csv().replace("0.6\n", "1e300\n"), {}, ""),
        (csv() + "1e300,0,0,0\n", {}, ""),
        ("t,x,y,z\n" + "9" * 200_000, {}, "CSV"),
        (LONG, {}, "under the least of 20"),
        (csv(), {"units": "parsec"}, "units 'parsec' are unknown; known: m, cm, mm, in"),
        (csv(), {"format": "xls"}, "format 'xls' is unknown; known: csv, robottasks"),
        (csv(), {"rate": "nan"}, "rate of nan Hz"),
        (csv(), {"rate": "often"}, "query.rate: it should be a valid number"),
        (csv(), {"name": "x" * 201}, "query.name"),
        (csv(), {"scene": "paper"}, "does not begin at the object of scene paper"),
        (b"", {"format": "robottasks"}, "the file is empty"),
        (b"rubbish", {"format": "robottasks"}, "not a whole .npy array"),
        (b"PK\x03\x04rubbish", {"format": "robottasks"}, "not a whole .npy array"),
        (npy(np.zeros((2, 30, 7)))[:-100], {"format": "robottasks"}, "not a whole .npy array"),
        (npy(np.zeros((2, 30, 7))).replace(b"(2, 30", b"(20000000, 30000000"), {"format": "robottasks"}, "not a whole"),
        (npy(np.zeros((2, 30, 3))), {"format": "robottasks"}, "the array must be floats"),
        (npy(np.zeros((0, 30, 7))), {"format": "robottasks"}, ""),
        (npy(np.zeros((2, 0, 7))), {"format": "robottasks"}, "too few"),
        (npy(np.full((2, 30, 7), np.inf)), {"format": "robottasks"}, "not finite"),
    ],
)
def test_a_file_that_cannot_be_used_is_a_sentence_and_leaves_nothing(
    desk: Desk, content: bytes | str, query: dict[str, str], sentence: str
) -> None:
    refused(desk.import_("imported-badly", content, **query), 422, sentence)
    assert desk.get("/tasks/imported-badly/demonstrations").json() in ([], NOT_THERE)


NOT_THERE = {"detail": "there is no task 'imported-badly'", "error": "NotFound"}


def test_a_file_is_imported_in_its_units_and_read_back(desk: Desk) -> None:
    inches = csv().replace("t,x,y,z", "t,x,y,z")
    (made,) = desk.import_("inches", inches, units="in", name="mine.csv").json()
    assert (made["source"], made["samples"], made["verdict"], made["number"]) == ("mine.csv", 60, "clean", 1)
    way = desk.get(f"/demonstrations/{made['id']}/trajectory").json()
    assert way["positions"][-1][0] - way["positions"][0][0] == pytest.approx(0.59 * 0.0254)
    assert desk.get(f"/demonstrations/{made['id']}").json() == made
    recording = desk.get(f"/demonstrations/{made['id']}/recording")
    assert recording.content.startswith(b"\x89MCAP0\r\n")
    turned = np.zeros((3, 40, 7))
    turned[..., 3], turned[..., 0] = 1.0, np.linspace(0.4, 0.6, 40)
    assert len(desk.import_("array", npy(turned), format="robottasks").json()) == 3


def test_an_empty_scene_of_tasks_shows_lists(desk: Desk) -> None:
    desk.http.put(f"{API}/tasks/bare", json={})
    for resource in ("demonstrations", "jobs", "runs", "recording"):
        assert desk.get(f"/tasks/bare/{resource}").json() == []
    health = desk.get("/health").json()
    assert health["executor"] is None
    assert [s["name"] for s in desk.get("/scenes").json()] == ["paper", "empty"]
    assert [c["name"] for c in desk.get("/calibrations").json()] == ["identity", "robottasks"]


# jobs and their outcomes


def test_a_task_without_demonstrations_fails_with_a_sentence(desk: Desk) -> None:
    desk.http.put(f"{API}/tasks/unshown", json={})
    job = desk.ended(desk.post("/tasks/unshown/jobs", {"kind": "learn"}))
    assert (job["state"], job["outcome"]) == ("failed", "")
    assert job["message"] == "task unshown has no usable demonstrations yet; show it a few times first"
    refused(desk.post(f"/jobs/{job['id']}/cancel"), 409, "has already failed")
    assert [j["id"] for j in desk.get("/tasks/unshown/jobs").json()] == [job["id"]]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ('{"keeep": 1}', "there is no setting learning.keeep; known here: mode, keep"),
        ('{"keep": "two"}', "setting learning.keep is 'two'; it should be a valid integer"),
        ('{"keep": true}', "setting learning.keep is True"),
        ('{"keep": 0}', "learning.keep"),
        ('{"threshold": NaN}', "setting learning.threshold is nan; it should be a finite number"),
        ('{"threshold": []}', "setting learning.threshold"),
        ('{"mode": "other"}', "learning.mode is 'other'; it is one of default, paper"),
        ('{"mode": "\\ud800"}', "settings cannot be read"),
        ('{"mode": "paper"}', "set learning.threshold in metres"),
        (f'{{"seed": 1{"0" * 400}}}', "too large"),
        ("[]", "body.settings: it should be a valid dictionary"),
    ],
)
def test_a_wrong_learning_setting_is_refused_at_once(desk: Desk, changes: str, sentence: str) -> None:
    desk.http.put(f"{API}/tasks/unshown", json={})
    before = len(desk.get("/tasks/unshown/jobs").json())
    body = f'{{"kind": "learn", "settings": {changes}}}'
    json_ = {"content-type": "application/json"}
    refused(desk.http.post(f"{API}/tasks/unshown/jobs", content=body, headers=json_), 422, sentence)
    refused(desk.post("/tasks/unshown/jobs", {"kind": "dance"}), 422, "body.kind: it should be 'learn' or 'plan'")
    assert len(desk.get("/tasks/unshown/jobs").json()) == before


def test_one_single_demonstration_is_learned_and_its_outcome_is_found(desk: Desk) -> None:
    desk.import_("single", csv(120, step=0.002))
    job = desk.ended(desk.post("/tasks/single/jobs", {"kind": "learn", "settings": {"seed": 2}}))
    assert job["state"] == "succeeded", job["message"]
    (run,) = desk.get("/tasks/single/runs").json()
    assert run == desk.get(f"/tasks/single/runs/{job['outcome']}").json()
    assert [len(c["members"]) for c in run["learned"]["clusters"]] == [1]
    assert run["learned"]["clusters"][0]["note"]
    assert run["learned"]["settings"]["seed"] == 2
    (path,) = run["learned"]["paths"]
    assert desk.get(f"/paths/{path['id']}").json() == path
    assert path["fit"]["largest"] <= path["fit"]["bound"]
    assert desk.get(f"/paths/{path['id']}/plans").json() == []

    desk.http.put(f"{API}/tasks/other", json={})
    refused(desk.get(f"/tasks/other/runs/{run['id']}"), 404, "it is of task single")
    refused(desk.post("/tasks/other/jobs", {"kind": "plan", "path": path["id"]}), 404, "it is of task single")
    for accepted in (
        desk.post(f"/paths/{path['id']}/plans"),
        desk.post("/tasks/single/jobs", {"kind": "plan", "path": path["id"]}),
    ):
        ended = desk.ended(accepted)
        assert ended["state"] in ("succeeded", "failed")
        assert (ended["state"] == "succeeded") == bool(ended["outcome"]) == (not ended["message"])


@pytest.mark.parametrize("settings_", [{}, {"mode": "paper", "threshold": 0.06}])
def test_a_demonstration_shorter_than_the_window_is_learned_with_a_note(desk: Desk, settings_: dict[str, Any]) -> None:
    task = f"short-{settings_.get('mode', 'default')}"
    for _ in range(3):
        desk.import_(task, csv(21))
    job = desk.ended(desk.post(f"/tasks/{task}/jobs", {"settings": settings_}))
    assert job["state"] == "succeeded", job["message"]
    learned = desk.get(f"/tasks/{task}/runs/{job['outcome']}").json()["learned"]
    assert all(cluster["note"] for cluster in learned["clusters"])


def test_identical_points_are_refused_with_a_sentence(desk: Desk) -> None:
    for _ in range(2):
        assert desk.import_("still", csv(60, step=0.0).replace("0.0", "0.0")).status_code == 201
    still = "t,x,y,z\n" + "".join(f"{i * 0.02},0.4,0,0.6\n" for i in range(60))
    answer = desk.import_("frozen", still)
    if answer.status_code == 201:
        job = desk.ended(desk.post("/tasks/frozen/jobs", {}))
        assert job["state"] == "failed"
        assert len(job["message"]) > 20
        assert "fault of teachpath" not in job["message"]
    else:
        refused(answer, 422, "")


# executions


def test_without_an_executor_an_execution_is_503_and_kept_with_its_reason(desk: Desk) -> None:
    plan = planned(desk.station, "plan-good")
    assert desk.get(f"/plans/{plan}").json()["id"] == plan
    refused(desk.post("/executions", {"plan": plan}), 503, "nobody answered")
    newest = desk.get("/executions").json()[0]
    assert (newest["plan"], newest["status"]["state"]) == (plan, "faulted")
    assert "nobody answered" in newest["status"]["reason"]
    assert desk.get(f"/executions/{newest['id']}").json() == newest
    for verb in ("hold", "resume", "stop"):
        refused(desk.post(f"/executions/{newest['id']}/{verb}"), 409, "is not running")
    refused(desk.post(f"/executions/{newest['id']}/override", {"override": 0.5}), 409, "is not running")
    refused(desk.post(f"/executions/{newest['id']}/jump"), 422, "path.verb: it should be 'hold', 'resume' or 'stop'")


# the description


def test_the_description_is_as_it_was(desk: Desk) -> None:
    live = openapi.text(desk.http.get("/openapi.json").json())
    assert live == openapi.FILE.read_text(), "the API has changed; if it should: python -m tests.contract.openapi"


def test_every_resource_is_described_with_its_refusals(desk: Desk) -> None:
    description = desk.http.get("/openapi.json").json()
    assert desk.http.get("/docs").status_code == 200
    for path, methods in description["paths"].items():
        for method, operation in methods.items():
            assert len(operation["description"]) > 10, (method, path)
            assert {"404", "409", "422", "503"} <= set(operation["responses"]), (method, path)
            assert any(status.startswith("2") for status in operation["responses"]), (method, path)
            for status, response in operation["responses"].items():
                if status[0] in "45":
                    assert response["content"]["application/json"]["schema"]["$ref"].endswith("/Refusal")


# whatever comes

WORD = st.one_of(st.sampled_from(["t", "lift", "..", "moon", "x" * 65]), st.text(max_size=20))
ANY = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
FIELDS = st.sampled_from(["task", "tracker", "plan", "path", "override", "kind", "settings", "scene", "calibration"])


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(pick=st.integers(0, 10_000), words=st.lists(WORD, min_size=3, max_size=3), body=st.dictionaries(FIELDS, ANY))
def test_whatever_is_sent_is_answered_without_a_fault(desk: Desk, pick: int, words: list[str], body: Any) -> None:
    operations = [
        (method.upper(), path) for path, methods in desk.station.web.openapi()["paths"].items() for method in methods
    ]
    method, path = operations[pick % len(operations)]
    for word in words:
        head, mark, tail = path.partition("{")
        path = (
            head + (word.encode(errors="replace").hex("%") if False else word) + tail.partition("}")[2]
            if mark
            else path
        )
    try:
        content = json.dumps(body)
        answer = desk.http.request(method, path, content=content, headers={"content-type": "application/json"})
    except (ValueError, UnicodeError):
        return  # the client itself refuses such an address
    assert answer.status_code < 500, (method, path, body, answer.text)
    if answer.status_code >= 400 and answer.status_code != 400:
        assert isinstance(answer.json()["detail"], str)
