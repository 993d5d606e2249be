"""Tasks are deleted, brought back and renamed with all that is theirs, and nothing of them is lost."""

from dataclasses import replace

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.records import JobState
from tests.contract.desk import Desk, csv, refused
from tests.contract.rows import a_job, learned
from tests.unit.io.test_documents import a_plan

RESOURCES = ("demonstrations", "runs", "jobs")


def taught(desk: Desk, task: str) -> str:
    """Let a task have a demonstration, a run with a path, and a plan of it; return the plan's id."""
    desk.import_(task, csv())
    store = desk.station.store
    for key in (f"learn-{task}", f"plan-{task}"):
        store.add_job(a_job(key, task=task, state=JobState.RUNNING, station="elsewhere"))
    run = store.run(store.finish_learning(f"learn-{task}", learned()))
    plan = replace(a_plan(), id=f"plan-of-{task}", path=run.learned.paths[0].id)
    return store.finish_planning(f"plan-{task}", plan)


def names(desk: Desk, **query: bool) -> list[str]:
    return [task["name"] for task in desk.get("/tasks", params=query).json()]


def listed(desk: Desk, resource: str, task: str) -> bool:
    return any(entry["task"] == task for entry in desk.get(resource).json())


def test_a_deleted_task_is_kept_and_comes_back_as_it_was(desk: Desk) -> None:
    taught(desk, "gone")
    before = [desk.get(f"/tasks/gone/{resource}").json() for resource in RESOURCES]
    deleted = desk.send("DELETE", "/api/v1/tasks/gone").json()
    assert deleted["archived_ns"] > deleted["created_ns"]
    assert desk.send("DELETE", "/api/v1/tasks/gone").json() == deleted
    assert "gone" not in names(desk)
    assert "gone" in names(desk, archived=True)
    assert desk.get("/tasks/gone").json() == deleted
    assert [desk.get(f"/tasks/gone/{resource}").json() for resource in RESOURCES] == before
    assert not any(listed(desk, resource, "gone") for resource in ("/runs", "/paths", "/plans"))
    assert desk.post("/tasks/gone/restore").json() == deleted | {"archived_ns": 0}
    assert desk.post("/tasks/gone/restore").json() == deleted | {"archived_ns": 0}
    assert "gone" in names(desk)
    assert "gone" not in names(desk, archived=True)
    assert all(listed(desk, resource, "gone") for resource in ("/runs", "/paths", "/plans"))
    refused(desk.send("DELETE", "/api/v1/tasks/moon"), 404, "no task 'moon'")
    refused(desk.post("/tasks/moon/restore"), 404, "no task 'moon'")


def test_nothing_begins_with_a_deleted_task(desk: Desk) -> None:
    plan = taught(desk, "closed")
    path = desk.get(f"/plans/{plan}").json()["path"]
    desk.send("DELETE", "/api/v1/tasks/closed")
    way_out = "task closed was deleted, and is kept; bring it back first (teachpath task restore closed)"
    for answer in (
        desk.put("/tasks/closed", {}),
        desk.post("/tasks/closed/recording", {"tracker": "glove"}),
        desk.post("/tasks/closed/jobs", {"kind": "learn"}),
        desk.upload("closed", csv()),
        desk.post(f"/paths/{path}/plans"),
        desk.post(f"/paths/{path}/adaptations", {}),
        desk.post("/executions", {"plan": plan}),
    ):
        refused(answer, 409, way_out)


def test_a_renamed_task_takes_all_that_is_its_own_along(desk: Desk) -> None:
    plan = taught(desk, "former")
    before = {resource: desk.get(f"/tasks/former/{resource}").json() for resource in RESOURCES}
    task = desk.get("/tasks/former").json()
    renamed = desk.send("PATCH", "/api/v1/tasks/former", json={"name": "latter"})
    assert renamed.json() == task | {"name": "latter"}
    assert renamed.headers["location"] == "/api/v1/tasks/latter"
    for resource, entries in before.items():
        assert desk.get(f"/tasks/latter/{resource}").json() == [entry | {"task": "latter"} for entry in entries]
    assert listed(desk, "/plans", "latter")
    assert desk.get(f"/plans/{plan}").status_code == 200
    (shown,) = before["demonstrations"]
    assert desk.get(f"/demonstrations/{shown['id']}/trajectory").status_code == 200
    assert desk.get(f"/demonstrations/{shown['id']}/recording").content.startswith(b"\x89MCAP0")
    refused(desk.get("/tasks/former"), 404, "no task 'former'")
    (second,) = desk.import_("latter", csv(70))
    assert second["number"] == shown["number"] + 1
    assert desk.import_("former", csv())[0]["number"] == 1  # the name is free


@pytest.mark.parametrize(
    ("name", "status", "sentence"),
    [
        ("taken", 409, "there is a task taken already"),
        ("deleted", 409, "there is a task deleted already, which was deleted; bring it back with"),
        ("a/b", 422, "cannot name a task"),
        ("", 422, "cannot name a task"),
    ],
)
def test_a_name_that_cannot_be_is_refused(desk: Desk, name: str, status: int, sentence: str) -> None:
    for task in ("mine", "taken", "deleted"):
        if desk.get(f"/tasks/{task}").status_code == 404:
            desk.put(f"/tasks/{task}", {})
    desk.send("DELETE", "/api/v1/tasks/deleted")
    refused(desk.send("PATCH", "/api/v1/tasks/mine", json={"name": name}), status, sentence)
    assert desk.send("PATCH", "/api/v1/tasks/mine", json={"name": "mine"}).json()["name"] == "mine"


def test_a_task_at_work_is_neither_deleted_nor_renamed(desk: Desk) -> None:
    desk.put("/tasks/busy", {})
    desk.post("/tasks/busy/recording", {"tracker": "busy-glove"})
    changes = [("DELETE", {}), ("PATCH", {"json": {"name": "idle"}})]
    for method, body in changes:
        refused(desk.send(method, "/api/v1/tasks/busy", **body), 409, "is being recorded from busy-glove; stop that")
    desk.post("/tasks/busy/recording/stop", {"tracker": "busy-glove"})
    store = desk.station.store
    store.add_job(a_job("learn-busy", task="busy", state=JobState.RUNNING, station="elsewhere"))
    for method, body in changes:
        refused(desk.send(method, "/api/v1/tasks/busy", **body), 409, "1 jobs of task busy wait or run")
    store.claims.cancel("learn-busy")


def test_the_object_of_a_task_that_was_renamed_is_looked_for_no_more(desk: Desk) -> None:
    desk.import_("shown-now", csv(), scene="empty")
    desk.send("PATCH", "/api/v1/tasks/shown-now", json={"name": "shown-later"})
    assert desk.put("/scenes/paper/object", {"position": [0.5, 0.1, 0.6]}).status_code == 200
    assert desk.send("DELETE", "/api/v1/scenes/paper/object").status_code == 200
    assert desk.get("/health").json()["guidance"]["task"] != "shown-now"


def test_the_command_line_deletes_restores_and_renames(desk: Desk, port: int) -> None:
    desk.put("/tasks/typed", {})
    url = ["--url", f"http://127.0.0.1:{port}"]

    def said(*words: str) -> str:
        outcome = CliRunner().invoke(app, [*words, *url], catch_exceptions=False)
        assert outcome.exit_code == 0, outcome.output
        return outcome.output

    assert "teachpath task restore typed" in said("task", "delete", "typed")
    assert "typed" in said("tasks", "--archived")
    assert "deleted" in said("tasks", "typed")
    assert "typed" not in said("tasks").split()
    assert "is back" in said("task", "restore", "typed")
    assert "is called typed-anew now" in said("task", "rename", "typed", "typed-anew")
    assert "typed-anew" in said("tasks")
