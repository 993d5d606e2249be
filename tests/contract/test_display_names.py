"""A task has a display name beside its name: in REST, in the client, at the command line."""

from pathlib import Path

from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath_client import Station
from tests.contract.desk import Desk, csv, refused


def test_a_task_is_called_what_people_like(desk: Desk) -> None:
    made = desk.put("/tasks/kueche-raeumen", {"display_name": " Küche räumen "}).json()
    assert (made["name"], made["display_name"]) == ("kueche-raeumen", "Küche räumen")
    assert desk.put("/tasks/kueche-raeumen", {}).json() == made
    changed = desk.send("PATCH", "/api/v1/tasks/kueche-raeumen", json={"display_name": "Spüle"}).json()
    assert changed == made | {"display_name": "Spüle"}
    renamed = desk.send("PATCH", "/api/v1/tasks/kueche-raeumen", json={"name": "sink"}).json()
    assert renamed == changed | {"name": "sink"}
    assert desk.send("PATCH", "/api/v1/tasks/sink", json={"display_name": ""}).json()["display_name"] == ""


def test_no_two_tasks_are_called_alike(desk: Desk) -> None:
    desk.put("/tasks/first-one", {"display_name": "Grüne Kiste"})
    alike = "looks like the name of task first-one, called 'Grüne Kiste'; choose that task, or give another name"
    refused(desk.put("/tasks/second-one", {"display_name": "GRUENE  KISTE"}), 409, alike)
    refused(desk.get("/tasks/second-one"), 404, "no task")
    desk.put("/tasks/second-one", {})
    changes = "/api/v1/tasks/second-one"
    refused(desk.send("PATCH", changes, json={"display_name": "Grüne Kiste"}), 409, alike)
    refused(
        desk.send("PATCH", changes, json={"display_name": "First one"}), 409, "looks like the name of task first-one"
    )
    mixed = "mixes Latin and Cyrillic letters, which look alike"
    refused(desk.send("PATCH", changes, json={"display_name": "K\u0443che"}), 422, mixed)
    assert desk.get("/tasks/second-one").json()["display_name"] == ""


def test_the_command_line_takes_the_name_that_people_know(desk: Desk, port: int, tmp_path: Path) -> None:
    desk.import_("typed-once", csv())
    url = ["--url", f"http://127.0.0.1:{port}"]

    def said(*words: str) -> str:
        outcome = CliRunner().invoke(app, [*words, *url], catch_exceptions=False)
        assert outcome.exit_code == 0, outcome.output
        return outcome.output

    assert "is called Bögen löten (boegen-loeten) now" in said("task", "rename", "typed-once", "Bögen löten")
    assert "task boegen-loeten, called Bögen löten: scene" in said("tasks", "Bögen löten")
    assert "Bögen löten" in said("tasks")
    assert "clean" in said("demonstrations", "Bögen löten")
    assert "is deleted" in said("task", "delete", "Bögen löten")
    with Station(f"http://127.0.0.1:{port}") as station:
        assert station.rename_task("boegen-loeten", display_name="Löten").display_name == "Löten"
        assert station.rename_task("boegen-loeten", "loeten").display_name == "Löten"


def test_an_import_makes_a_task_of_any_name(tmp_path: Path) -> None:
    file, folder = tmp_path / "one.csv", tmp_path / "data"
    file.write_text(csv())
    options = ["--data", str(folder)]
    run = CliRunner().invoke(app, ["import", "Äpfel legen", str(file), *options], catch_exceptions=False)
    assert run.exit_code == 0, run.output
    store = Store(StoreSettings(data_dir=str(folder)))
    (task,) = store.tasks()
    store.close()
    assert (task.name, task.display_name) == ("aepfel-legen", "Äpfel legen")
