"""The audit log of a station: who did what, from where, and how it was answered."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.access.passwords import hash_password
from teachpath.commands.serving import changed_settings
from teachpath.config import load
from teachpath.io.audit_log import LOG
from teachpath.records import AuditEntry, Capability, JournalEntry, Person
from teachpath_proto.control import JournalVerb
from tests.contract.desk import refused
from tests.contract.guarded import Guarded, opened
from tests.waiting import wait_until

PASSWORD = "four words put together"


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        guarded.station.audit.start()
        yield guarded


def entry(guarded: Guarded, action: str) -> AuditEntry:
    """Wait for the newest entry whose action begins so."""
    found = list[AuditEntry]()

    def has_come() -> bool:
        found[:] = [each for each in guarded.station.audit.log.entries() if each.action.startswith(action)]
        return bool(found)

    wait_until(has_come, f"{action} is written")
    return found[-1]


def test_an_order_is_written_with_who_from_where_what_and_the_answer(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.OPERATE, **{"Teachpath-Operator": "Anna"})
    refused(guarded.desk.post("/executions", {"plan": "moon", "override": 0.5}, headers=headers), 422, "no plan")
    written = entry(guarded, "POST /api/v1/executions {")
    assert written.action == 'POST /api/v1/executions {"plan":"moon","override":0.5}'
    assert (written.who, written.source) == ("operate (Anna)", "127.0.0.1")
    assert written.answer == "422: body.plan: there is no plan 'moon'"


def test_a_refusal_is_written_even_of_a_reader(guarded: Guarded) -> None:
    refused(guarded.desk.get("/tasks?written=1"), 401, "send a token")
    written = entry(guarded, "GET /api/v1/tasks")
    assert (written.who, written.answer[:5]) == ("", "401: ")
    refused(guarded.desk.get("/tokens", headers=guarded.headers(Capability.VIEW)), 403, "this needs administer")
    assert entry(guarded, "GET /api/v1/tokens").who == "view"


def test_so_are_stops_and_tokens(guarded: Guarded) -> None:
    guarded.desk.post("/executions/moon/stop")
    assert entry(guarded, "POST /api/v1/executions/moon/stop").who == "not signed in"
    admin = guarded.headers(Capability.ADMINISTER)
    order = {"name": "cell-9", "roles": ["operate"]}
    token = guarded.desk.post("/tokens", order, headers=admin).json()["token"]
    written = entry(guarded, "POST /api/v1/tokens")
    assert (written.who, written.answer) == ("administer", "201")
    assert "cell-9" in written.action
    guarded.desk.send("DELETE", "/api/v1/tokens/cell-9", headers=admin)
    assert entry(guarded, "DELETE /api/v1/tokens/cell-9").answer == "200"
    assert token not in str(list(guarded.station.audit.log.entries()))


def test_sign_ins_are_written_with_the_name_and_without_the_password(guarded: Guarded) -> None:
    kept = hash_password(PASSWORD, "anna")
    guarded.station.store.people.add(Person("anna", (Capability.TEACH,), kept, 1, 1))
    guarded.station.access.refresh()
    for password, answer in (("secret that is wrong", "401: "), (PASSWORD, "200")):
        guarded.desk.post("/session", {"name": "anna", "password": password})
        wait_until(lambda answer=answer: entry(guarded, "POST /api/v1/session").answer.startswith(answer), answer)
        assert entry(guarded, "POST /api/v1/session").who == "who signs in as anna"
        assert password not in str(list(guarded.station.audit.log.entries()))


def test_what_the_executor_says_is_written(guarded: Guarded) -> None:
    guarded.station.audit.note_journal(JournalEntry(1, "cell-3", JournalVerb.START, "e1", "done"))
    assert entry(guarded, "start e1").source == "executor"


def test_readers_and_beats_are_not_written(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.OPERATE)
    guarded.desk.get("/scenes", headers=headers)
    guarded.desk.post("/lease/beat", headers=headers)
    guarded.desk.post("/executions/end-of-test/stop")
    entry(guarded, "POST /api/v1/executions/end-of-test")
    said = {each.action for each in guarded.station.audit.log.entries()}
    assert not {"GET /api/v1/scenes", "POST /api/v1/lease/beat"} & said


def test_administrators_read_it_page_by_page(guarded: Guarded) -> None:
    admin = guarded.headers(Capability.ADMINISTER)
    with guarded.client(Capability.ADMINISTER) as client:
        numbers = [each["number"] for page in client.pages("/audit", limit=5) for each in page]
    assert numbers == sorted(numbers, reverse=True)
    page = guarded.desk.get("/audit?limit=2", headers=admin)
    assert len(page.json()) == 2
    assert 'rel="next"' in page.headers["link"]
    refused(guarded.desk.get("/audit?after=x", headers=admin), 422, "is no cursor of this list")
    refused(guarded.desk.get("/audit", headers=guarded.headers(Capability.OPERATE)), 403, "this needs administer")


def test_the_log_of_the_station_is_whole(guarded: Guarded) -> None:
    assert guarded.station.audit.log.verify() == ""


# the command line


def invoke(*words: str) -> tuple[str, str]:
    result = CliRunner().invoke(app, words)
    return result.output, str(result.exception or "")


def test_the_command_line_writes_verifies_and_exports(tmp_path: Path) -> None:
    data = ("--data", str(tmp_path / "data"))
    invoke("token", "create", "--role", "view", "--name", "cell-3", *data)
    invoke("token", "revoke", "cell-3", *data)
    said, _ = invoke("audit", "verify", *data)
    assert said.startswith("2 entries are whole; hash of the newest: ")
    entries = [json.loads(line) for line in invoke("audit", "export", *data)[0].splitlines()]
    assert [each["action"] for each in entries] == ["create token cell-3, view, for 90 days", "revoke token cell-3"]
    assert {each["source"] for each in entries} == {"command line"}
    assert invoke("audit", "verify", "--noted", entries[0]["hash"], *data)[1] == ""
    file = tmp_path / "data" / LOG
    file.write_text(file.read_text().replace("view", "operate"))
    assert invoke("audit", "verify", *data)[1] == "the audit log is broken: entry 1: it was changed"


def test_people_are_written_without_their_passwords(tmp_path: Path) -> None:
    data, runner = ("--data", str(tmp_path / "data")), CliRunner()
    for words in (("add", "anna", "--role", "teach"), ("password", "anna"), ("remove", "anna")):
        assert runner.invoke(app, ["person", *words, *data], input=f"{PASSWORD}\n").exception is None
    said, _ = invoke("audit", "export", *data)
    actions = [json.loads(line)["action"] for line in said.splitlines()]
    assert actions == ["add person anna, teach", "change the password of anna", "remove person anna"]
    assert PASSWORD not in said


def test_settings_are_written_as_they_differ_from_the_defaults_without_the_database() -> None:
    store = {"database": "postgresql+psycopg://user:secret@host/teachpath", "data_dir": "elsewhere"}
    said = changed_settings(load(document={"store": store, "auth": {"mode": "token"}}))
    assert json.loads(said) == {"auth": {"mode": "token"}, "store": {"data_dir": "elsewhere"}}
