"""One number follows a request: in the header of its answer, in the log, and in the job and command that it begins."""

import logging

import pytest

from teachpath.io.wire import decode_command, encode_status
from teachpath.records import Command, ExecutorStatus
from tests.contract.desk import Desk
from tests.waiting import wait_until


def test_every_answer_has_a_number_of_its_own(desk: Desk) -> None:
    answers = [desk.get("/tasks"), desk.get("/tasks/moon"), desk.send("GET", "/"), desk.send("GET", "/none")]
    numbers = [answer.headers["teachpath-request"] for answer in answers]
    assert len(set(numbers)) == len(numbers)
    assert all(len(number) == 12 for number in numbers)


def test_a_job_is_logged_under_the_number_of_its_request(desk: Desk, caplog: pytest.LogCaptureFixture) -> None:
    desk.put("/tasks/numbered", {})
    with caplog.at_level(logging.INFO, logger="teachpath"):
        accepted = desk.post("/tasks/numbered/jobs", {"kind": "learn"})
        job = desk.ended(accepted)

        def of_job() -> list[logging.LogRecord]:
            return [one for one in list(caplog.records) if job["id"] in one.getMessage() and hasattr(one, "request")]

        ended = lambda: any("has no usable demonstrations" in record.getMessage() for record in of_job())  # noqa: E731
        wait_until(ended, "its end, which was stored before, is logged")
    said = of_job()
    assert {record.request for record in said} == {accepted.headers["teachpath-request"]}
    assert any(record.getMessage().startswith("POST /api/v1/tasks/numbered/jobs: 202") for record in caplog.records)


def test_a_command_carries_the_number_of_its_request_to_the_executor(desk: Desk) -> None:
    station, heard = desk.station, list[Command]()

    def answer(payload: bytes) -> bytes:
        heard.append(decode_command(payload))
        return encode_status(ExecutorStatus())

    handle = station.bus.serve(station.keys.executor_command, answer)
    try:
        answered = desk.post("/robot/acknowledge")
    finally:
        handle.close()
    assert answered.is_success, answered.text
    assert [command.id for command in heard] == [answered.headers["teachpath-request"]]


def test_answers_of_the_api_are_kept_and_guessed_by_no_browser_and_given_to_no_other_site(desk: Desk) -> None:
    for place in ("/api/v1/tasks", "/api/v1/nothing"):
        headers = desk.send("GET", place).headers
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cache-control"] == "no-store"
        assert headers["cross-origin-resource-policy"] == "same-origin"


@pytest.mark.parametrize(
    "name", ["%00", "a%00.js", "x" * 5000 + ".js", "a/" * 3000 + "b.js", "%ff%fe.js", "%ED%A0%80", "page.js/a.js"]
)
def test_what_no_file_can_be_named_is_not_there(desk: Desk, name: str) -> None:
    for folder in ("web", "vendor"):
        assert desk.send("GET", f"/{folder}/{name}").status_code == 404
