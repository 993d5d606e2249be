"""Adaptations of a path over REST and on the command line: a new version with its certificate, or a sentence."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import UnusableInput
from tests.contract.desk import Desk, refused

TASK = "elsewhere"
PAPER_START = np.array([0.58, -0.28, 0.52])  # where the scene has its object
START, GOAL = np.array([0.45, -0.2, 0.6]), np.array([0.45, 0.2, 0.6])


def shown(goal: Any, seed: int, *, start: Any = START) -> str:
    """A bow from the start to a goal, as CSV."""
    share = np.linspace(0, 1, 100)[:, None]
    s = 10 * share**3 - 15 * share**4 + 6 * share**5
    height = 0.1 + np.random.default_rng(seed).normal(0, 0.003)
    points = start + s * (goal - start) + np.sin(np.pi * s) * [0, 0, height]
    rows = [f"{0.02 * i},{x:.6f},{y:.6f},{z:.6f}\n" for i, (x, y, z) in enumerate(points)]
    return "t,x,y,z\n" + "".join(rows)


@dataclass(frozen=True)
class Taught:
    """A path that was learned from two goals, and its task."""

    path: str
    start: list[float]
    goal: list[float]


@pytest.fixture(scope="module")
def taught(desk: Desk) -> Taught:
    for number in range(6):
        assert desk.import_(TASK, shown(GOAL + (number % 2) * np.array([0.1, 0.0, 0.0]), number))
    job = desk.ended(desk.post(f"/tasks/{TASK}/jobs", {"settings": {"repeats": 0}}))
    assert job["state"] == "succeeded", job["message"]
    learned = desk.get(f"/tasks/{TASK}/runs/{job['outcome']}").json()["learned"]
    assert len(learned["paths"]) == 2
    path = learned["paths"][0]
    points = path["curve"]["control_points"]
    return Taught(path["id"], points[0], points[-1])


def adapted(desk: Desk, taught: Taught, shift: Any, **more: Any) -> Any:
    goal = np.add(taught.goal, shift).tolist()
    body = {"start": {"position": taught.start}, "goal": {"position": goal}}
    return desk.post(f"/paths/{taught.path}/adaptations", body | more)


def test_an_adaptation_is_a_new_version_with_its_certificate(desk: Desk, taught: Taught) -> None:
    before = desk.get(f"/paths/{taught.path}").json()
    answer = adapted(desk, taught, [0.05, 0.0, 0.0])
    assert answer.status_code == 201, answer.text
    found = answer.json()
    number = found["version"]["number"]
    assert answer.headers["location"] == f"/api/v1/paths/{taught.path}/versions/{number}"
    assert found["path"] == desk.get(f"/paths/{taught.path}").json()
    assert found["version"]["parent"] == before["version"]
    assert found["version"]["note"] == found["note"]
    assert (found["demonstrations"], found["places"], found["extrapolates"]) == (6, 2, "")
    assert max(found["spread"]) > 0
    points = np.array(found["path"]["curve"]["control_points"])
    shifted = np.add(taught.goal, [0.05, 0.0, 0.0])
    np.testing.assert_allclose(points[[0, -1]], [taught.start, shifted], atol=1e-9)
    job = desk.job_ended(found["job"]["id"])
    assert job["state"] == "succeeded", job["message"]
    assert job["request"]["version"] == number
    assert desk.get(f"/plans/{job['outcome']}").json()["path"] == taught.path


def test_an_adaptation_that_comes_again_with_its_key_is_answered_with_its_version(desk: Desk, taught: Taught) -> None:
    key = {"Idempotency-Key": "adapt once"}
    body = {"goal": {"position": np.add(taught.goal, [0.03, 0.0, 0.0]).tolist()}, "start": {"position": taught.start}}
    address = f"/paths/{taught.path}/adaptations"
    first = desk.post(address, body | {"branch": "once"}, headers=key)
    job = desk.job_ended(first.json()["job"]["id"])
    before = desk.get(f"/paths/{taught.path}/versions").json()
    again = desk.post(address, body | {"branch": "once"}, headers=key)
    assert (again.status_code, again.headers["location"]) == (201, first.headers["location"])
    assert again.json() == first.json() | {"job": job}
    assert desk.get(f"/paths/{taught.path}/versions").json() == before
    refused(desk.post(address, body | {"branch": "other"}, headers=key), 409, "send a new key with each order")
    assert desk.get(f"/paths/{taught.path}/versions").json() == before


def test_what_was_not_shown_is_told(desk: Desk, taught: Taught) -> None:
    found = adapted(desk, taught, [0.0, -0.35, 0.0], branch="near").json()
    assert "apart on the level, shown were" in found["extrapolates"]
    assert found["note"] == f"beyond what was shown: {found['extrapolates']}"


def test_between_its_own_ends_a_version_stays_and_is_certified(desk: Desk, taught: Taught) -> None:
    newest = desk.get(f"/paths/{taught.path}").json()
    points = newest["curve"]["control_points"]
    body = {"start": {"position": points[0]}, "goal": {"position": points[-1]}}
    answer = desk.post(f"/paths/{taught.path}/adaptations", body)
    assert (answer.status_code, answer.json()["path"]) == (200, newest)
    assert desk.get(f"/paths/{taught.path}").json() == newest
    assert desk.job_ended(answer.json()["job"]["id"])["request"]["version"] == newest["version"]


def test_a_start_that_nothing_tells_is_asked_for(desk: Desk, taught: Taught) -> None:
    refused(desk.post(f"/paths/{taught.path}/adaptations", {}), 422, "scene empty has no object, so nothing tells")


@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        ({"position": [0.4, 0.1]}, "body.start.position"),
        ({"position": [0.4, 0.1, 400]}, "body.start.position.2: it should be less than or equal to 10"),
        ({"position": [0.4, 0.1, None]}, "body.start.position.2"),
        ({"position": [0.4, 0.1, 0.5], "orientation": [1, 1, 0, 0]}, "no value of start.orientation"),
        ({"position": [0.4, 0.1, 0.5], "orientation": [0, 0, 0, 0]}, "no value of start.orientation"),
        ({"position": [0.4, 0.1, 0.5], "orientation": [1, 0, 0, 0]}, "this path has learned no orientations"),
        ({"positon": [0.4, 0.1, 0.5]}, "body.start.position"),
    ],
)
def test_what_is_no_pose_is_refused(desk: Desk, taught: Taught, start: Any, sentence: str) -> None:
    before = desk.get(f"/paths/{taught.path}/versions").json()
    body = {"start": start, "goal": {"position": [0.4, 0.2, 0.6]}}
    refused(desk.post(f"/paths/{taught.path}/adaptations", body), 422, sentence)
    assert desk.get(f"/paths/{taught.path}/versions").json() == before


@pytest.mark.parametrize("apart", [0.0, 1e-4])
def test_a_goal_at_the_start_is_refused(desk: Desk, taught: Taught, apart: float) -> None:
    x, y, z = taught.start
    body = {"start": {"position": [x, y, z]}, "goal": {"position": [x + apart, y, z]}}
    refused(desk.post(f"/paths/{taught.path}/adaptations", body), 422, "take the goal farther away")


@pytest.mark.parametrize(("goal", "said"), [([0.45, 0.2, -0.3], "lower"), ([9.9, 9.9, 9.9], "apart on the level")])
def test_what_the_arm_cannot_reach_is_told_and_gets_no_certificate(
    desk: Desk, taught: Taught, goal: list[float], said: str
) -> None:
    body = {
        "version": 1,
        "branch": f"far-{said}".replace(" ", "-"),
        "start": {"position": taught.start},
        "goal": {"position": goal},
    }
    found = desk.post(f"/paths/{taught.path}/adaptations", body).json()
    assert said in found["extrapolates"]
    job = desk.job_ended(found["job"]["id"])
    assert (job["state"], "outside the reach" in job["message"]) == ("failed", True)


@pytest.mark.parametrize(
    "raw",
    ['{"goal":{"position":[NaN,0,0]}}', '{"goal":{"position":[1e999,0,0]}}', "[]", '{"goal":{"position":"here"}}', "{"],
)
def test_what_is_no_request_is_refused(desk: Desk, taught: Taught, raw: str) -> None:
    answer = desk.post(f"/paths/{taught.path}/adaptations", json=None, content=raw.encode())
    assert answer.status_code == 422, answer.text


def test_an_unknown_path_or_version_is_not_found(desk: Desk, taught: Taught) -> None:
    refused(adapted(desk, taught, [0.05, 0, 0], version=999), 422, "no version 999")
    body = {"start": {"position": [0.4, 0.1, 0.5]}, "goal": {"position": [0.4, 0.2, 0.6]}}
    refused(desk.post("/paths/moon/adaptations", body), 404, "there is no path 'moon'")


def test_a_path_is_adapted_on_the_command_line(desk: Desk, taught: Taught, port: int) -> None:
    x, y, z = taught.goal
    words = ["adapt", taught.path, "--start", ",".join(map(str, taught.start)), "--goal", f"{x + 0.03},{y},{z}"]
    said = CliRunner().invoke(app, [*words, "--url", f"http://127.0.0.1:{port}"], catch_exceptions=False).output
    newest = desk.get(f"/paths/{taught.path}").json()
    assert f"version {newest['version']} of {taught.path}, on branch main: by 6 demonstrations at 2 places" in said
    np.testing.assert_allclose(newest["curve"]["control_points"][-1], [x + 0.03, y, z], atol=1e-9)


def test_ends_on_the_command_line_are_three_or_seven_numbers(taught: Taught) -> None:
    for text in ("here", "0.4,0.1", "1,2,3,4"):
        with pytest.raises(UnusableInput, match="is not x,y,z or x,y,z,qw,qx,qy,qz"):
            CliRunner().invoke(app, ["adapt", taught.path, "--start", text, "--goal", text], catch_exceptions=False)


def test_an_object_is_told_to_lie_elsewhere_and_a_path_adapted_to_it(desk: Desk) -> None:
    start, goal = PAPER_START, PAPER_START + np.array([0.0, 0.5, 0.0])
    for number in range(3):
        assert desk.import_("moved-object", shown(goal, number, start=start), scene="paper")
    job = desk.ended(desk.post("/tasks/moved-object/jobs", {"settings": {"repeats": 0}}))
    key = desk.get(f"/tasks/moved-object/runs/{job['outcome']}").json()["learned"]["paths"][0]["id"]
    lies = (start + np.array([-0.04, 0.05, 0.0])).tolist()
    try:
        assert desk.put("/scenes/paper/object", {"position": lies}).json()["position"] == lies
        assert desk.get("/scenes").json()[0]["carried"]["position"] == lies
        failed = desk.ended(desk.post(f"/paths/{key}/plans"))
        assert (failed["state"], "from where block stands" in failed["message"]) == ("failed", True)
        found = desk.post(f"/paths/{key}/adaptations", {}).json()
        assert found["path"]["object_pose"]["position"] == lies
        ends = np.array(found["path"]["curve"]["control_points"])[[0, -1]]
        np.testing.assert_allclose(ends, [lies, goal], atol=0.006)
        job = desk.job_ended(found["job"]["id"])
        assert job["state"] == "succeeded", job["message"]
        assert desk.get(f"/plans/{job['outcome']}").json()["scene"]["carried"]["position"] == lies
    finally:
        home = desk.send("DELETE", "/api/v1/scenes/paper/object").json()
    assert home == desk.get("/scenes/paper/object").json()
    assert home["position"] == PAPER_START.tolist()


def test_an_object_is_told_and_asked_for_on_the_command_line(desk: Desk, port: int) -> None:
    for option, place in (("--at=0.5,-0.25,0.52", "0.500, -0.250, 0.520"), ("--reset", "0.580, -0.280, 0.520")):
        words = ["object", "paper", option, "--url", f"http://127.0.0.1:{port}"]
        said = CliRunner().invoke(app, words, catch_exceptions=False).stdout
        assert f"the object of scene paper lies at {place} m" in said


@pytest.mark.parametrize(
    ("scene", "body", "status", "sentence"),
    [
        ("moon", {"position": [0.5, 0, 0.5]}, 404, "there is no scene 'moon'"),
        ("empty", {"position": [0.5, 0, 0.5]}, 404, "scene empty has no object"),
        ("paper", {"position": [0.5, 0]}, 422, "body.position"),
        ("paper", {"position": [0.5, 0, 11]}, 422, "body.position.2"),
        (
            "paper",
            {"position": [0.5, 0, 0.5], "orientation": [0, 0, 0, 0]},
            422,
            "is no value of an orientation",
        ),
        ("paper", {"positoin": [0.5, 0, 0.5]}, 422, "body.position"),
    ],
)
def test_what_is_no_pose_of_an_object_is_refused(desk: Desk, scene: str, body: Any, status: int, sentence: str) -> None:
    refused(desk.put(f"/scenes/{scene}/object", body), status, sentence)
