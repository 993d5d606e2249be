"""The command line: what it lists and shows, how things are named, where it finds the service, and that it is quick."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pytest
import typer
from typer.main import get_command
from typer.testing import CliRunner

from teachpath import __version__
from teachpath.__main__ import EXIT_STATUS, app
from teachpath.commands.options import LOCAL_ADDRESS, address, stop_addresses
from teachpath.errors import NotFound, UnusableInput
from teachpath.io.running_services import announced
from teachpath_client import Station
from tests.contract.desk import Desk, csv

TASK, SECOND = "listed", "listed-second"
HEAVY_PACKAGES = ("numpy", "scipy", "httpx", "zenoh", "google", "sqlalchemy", "rich", "teachpath.config")


@pytest.fixture(scope="module")
def url(port: int) -> str:
    return f"http://127.0.0.1:{port}"


@pytest.fixture(scope="module")
def station(desk: Desk, url: str) -> Iterator[Station]:
    """A station with a task that was learned and planned, and a second one that was learned."""
    with Station(url) as station:
        for task in (TASK, SECOND):
            for step in (0.002, 0.0021, 0.0022):
                desk.import_(task, csv(120, step=step), scene="empty")
            run = station.learn(task)
            if task == TASK:
                order = {"path": run.learned.paths[0].id, "version": 1}
                job = desk.station.jobs.submit(
                    task, "plan", order, "ada", who="ada"
                )  # as a token of that name orders it
                assert desk.job_ended(job.id)["state"] == "succeeded"
        yield station


def said(url: str, *words: str) -> str:
    return CliRunner().invoke(app, [*words, "--url", url], catch_exceptions=False).stdout


@pytest.mark.parametrize("kind", ["tasks", "runs", "paths", "plans", "jobs", "arms", "scenes"])
def test_a_list_prints_what_rest_answers(station: Station, url: str, kind: str) -> None:
    listed = json.loads(said(url, kind, "--json"))
    assert listed
    assert listed == station.call("GET", f"/{kind}")[:20]
    name = {"tasks": "name", "scenes": "name", "arms": "variant"}.get(kind, "id")
    assert all(entry[name] in said(url, kind) for entry in listed)


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        (("runs", TASK), "runs"),
        (("paths", f"{TASK}/1"), "paths"),
        (("paths", TASK), "paths"),
        (("plans", "last"), "plans"),
        (("plans", f"{TASK}/1"), "plans"),
    ],
)
def test_one_is_named_by_words_and_by_the_beginning_of_its_id(
    station: Station, url: str, words: tuple[str, str], kind: str
) -> None:
    shown = json.loads(said(url, *words, "--json"))
    meant = {
        "runs": lambda: station.newest_run(TASK),
        "paths": lambda: station.get_path(station.paths(TASK)[0].id),
        "plans": lambda: station.get_plan(station.plan_summaries(TASK)[0].id),
    }[kind]()
    assert shown == json.loads(json.dumps(asdict(meant)))
    for beginning in (shown["id"], shown["id"][:-1] if kind == "plans" else shown["id"], shown["id"].partition("-")[2]):
        assert json.loads(said(url, kind, beginning, "--json"))["id"] == shown["id"]
    assert shown["id"] in said(url, *words) or kind == "runs"


def test_a_plan_says_for_whom_it_was_made(station: Station, url: str) -> None:
    (listed,) = station.plan_summaries(TASK)
    assert listed.author == station.get_plan(listed.id).author == "ada"
    assert "planned for ada" in said(url, "plans", listed.id)
    assert re.search(r"\bada\b", said(url, "plans"))


def test_files_that_were_written_are_told(station: Station, url: str, tmp_path: Path) -> None:
    curve, motion = tmp_path / "curve.json", tmp_path / "motion.csv"
    exported = json.loads(said(url, "curve", "export", f"{TASK}/1", "--out", str(curve), "--json"))
    path = station.paths(TASK)[0].id
    assert exported == {"file": str(curve), "bytes": curve.stat().st_size, "path": path, "version": 1}
    saved = json.loads(said(url, "curve", "import", path, str(curve), "--branch", "again", "--json"))
    assert saved == json.loads(said(url, "curve", "list", path, "--json"))[-1]
    written = json.loads(said(url, "export", "plan", f"{TASK}/1", "-o", str(motion), "--json"))
    assert written == {"file": str(motion), "bytes": motion.stat().st_size}


def test_the_station_its_tasks_jobs_and_scenes_are_shown(station: Station, url: str) -> None:
    assert "no executor has said" in said(url, "status")
    assert json.loads(said(url, "status", "--json"))["version"] == station.health().version
    assert "3 clean" in said(url, "tasks", TASK)
    assert json.loads(said(url, "jobs", "last", "--json"))["id"] == station.jobs()[0].id
    assert "table" in said(url, "scenes", "paper")
    assert said(url, "executions", "--json").startswith("[")
    assert json.loads(said(url, "demonstrations", TASK, "--json"))[0]["task"] == TASK
    assert json.loads(said(url, "curve", "list", TASK, "--json"))[0]["number"] == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("runs", "moon"), "there is no run 'moon'; list them with: teachpath runs"),
        (("plans", "plan-000000000000"), "list them with: teachpath plans"),
        (("paths", "moon/1"), "task 'moon' has no learned path; list all with: teachpath paths"),
        (("paths", f"{TASK}/7"), f"there is no path {TASK}/7; the newest run of {TASK} has {TASK}/1"),
        (("plan", "run-000000000000-1"), "list them with: teachpath paths"),
        (("run", f"{SECOND}/1"), "path listed-second/1 has no plan; make one with: teachpath plan listed-second/1"),
        (("jobs", "moon"), "list them with: teachpath jobs"),
        (("executions", "moon"), "list them with: teachpath executions"),
        (("tasks", "moon"), "list them with: teachpath tasks"),
        (("demonstrations", "moon"), "list them with: teachpath tasks"),
        (("arms", "moon"), "list them with: teachpath arms"),
        (("scenes", "moon"), "list them with: teachpath scenes"),
    ],
)
@pytest.mark.usefixtures("station")
def test_what_is_not_there_is_said_with_the_way_to_a_list(url: str, words: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(NotFound, match=sentence):
        said(url, *words)


@pytest.mark.usefixtures("station")
def test_a_beginning_of_several_ids_is_refused_with_them(url: str) -> None:
    with pytest.raises(UnusableInput, match=r"runs begin with 'run-': run-\w+, run-\w+; write more of the one"):
        said(url, "runs", "run-")


def test_the_service_is_found_by_settings_and_by_what_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert address() == LOCAL_ADDRESS
    with announced("http://127.0.0.1:9001"):
        assert address() == "http://127.0.0.1:9001"
        monkeypatch.setenv("TEACHPATH_WEB__PORT", "9002")
        assert address() == "http://127.0.0.1:9002"
        monkeypatch.delenv("TEACHPATH_WEB__PORT")
        (tmp_path / "teachpath.toml").write_text("[web]\nport = 9003\n")
        assert address() == "http://127.0.0.1:9003"
        (tmp_path / "teachpath.toml").unlink()
    assert address() == LOCAL_ADDRESS


def test_of_several_services_none_is_guessed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    other = (
        "from teachpath.io.running_services import announced\n"
        f"with announced('{LOCAL_ADDRESS}'): print(flush=True); input()"
    )
    with subprocess.Popen([sys.executable, "-c", other], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert address() == LOCAL_ADDRESS
        with announced("http://127.0.0.1:9001"):
            with pytest.raises(UnusableInput, match="several services run"):
                address()
            assert stop_addresses() == [LOCAL_ADDRESS, "http://127.0.0.1:9001"]
        process.kill()
    assert address() == LOCAL_ADDRESS


def test_settings_that_cannot_be_read_keep_no_stop_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "teachpath.toml").write_text("[web\n")
    with announced("http://127.0.0.1:9001"):
        assert stop_addresses() == ["http://127.0.0.1:9001"]


@pytest.mark.parametrize(
    "words",
    ["export demonstrations demo", "export report demo", "doctor", "backup into", "import demo a.csv"],
)
def test_no_data_folder_is_made_by_mistake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NotFound, match=f"there is no data folder {tmp_path}/teachpath-data"):
        CliRunner().invoke(app, words.split(), catch_exceptions=False)
    assert list(tmp_path.iterdir()) == []


def commands(group: typer.core.TyperGroup, *path: str) -> Iterator[tuple[str, ...]]:
    for name, command in group.commands.items():
        yield (*path, name)
        if isinstance(command, typer.core.TyperGroup):
            yield from commands(command, *path, name)


def test_help_of_every_command_loads_nothing_heavy() -> None:
    group = get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    every = [[], *(list(path) for path in commands(group))]
    code = (
        "import sys\nfrom typer.testing import CliRunner\nfrom teachpath.__main__ import app\n"
        f"for words in {every!r}:\n"
        "    assert CliRunner().invoke(app, [*words, '--help']).exit_code == 0, words\n"
        f"print([name for name in {HEAVY_PACKAGES!r} if name in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"


def test_version_and_exit_status_are_said() -> None:
    assert CliRunner().invoke(app, ["--version"]).stdout == f"teachpath {__version__}\n"
    shown = " ".join(CliRunner().invoke(app, ["--help"]).stdout.split())
    assert " ".join(EXIT_STATUS.split()) in shown


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_completes(shell: str) -> None:
    asked = {"COMP_WORDS": "teachpath exe", "COMP_CWORD": "1", "_TYPER_COMPLETE_ARGS": "teachpath exe"}
    asked |= {"_TEACHPATH_COMPLETE": f"complete_{shell}", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    command = [sys.executable, "-m", "teachpath"]
    ended = subprocess.run(command, env=os.environ | asked, capture_output=True, text=True)
    assert {"executions", "executor"} <= set(re.findall(r"\bexecut\w+", ended.stdout))
