"""Motions as files over REST, by the client, and on the command line."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from uuid import uuid4

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import UnusableInput
from teachpath.io.programs.formats import FORMATS
from teachpath.io.signing_key import prepare_signing_key
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.signature import SigningKey, sign_plan
from teachpath.records import Job, JobState, Plan
from teachpath_client.station import Station
from tests.contract.desk import Desk, refused
from tests.contract.test_rest_work import planned
from tests.unit.motion.ways import MIDDLE, way


@pytest.fixture(scope="module")
def certified(desk: Desk) -> Plan:
    """A plan of the station's own."""
    station, settings = desk.station, desk.station.settings
    made = replace(plan(way(MIDDLE), empty_scene()), id=f"plan-{uuid4().hex[:12]}")
    key = SigningKey(prepare_signing_key(settings.bus.endpoint))
    signed = sign_plan(made, settings.arm, settings.motion, key, issued_ns=time.time_ns())
    station.store.ensure_task("programs", scene="paper", calibration="identity")
    station.store.add_job(Job("programs", "programs", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0))
    station.store.finish_planning("programs", signed)
    return signed


@pytest.fixture
def client(port: int) -> Iterator[Station]:
    with Station(f"http://127.0.0.1:{port}") as station:
        yield station


@pytest.mark.parametrize("name", FORMATS)
def test_a_certified_plan_is_taken_away_in_every_format(desk: Desk, certified: Plan, name: str) -> None:
    file = desk.get(f"/plans/{certified.id}/program", params={"format": name})
    assert file.status_code == 200
    assert file.headers["content-disposition"] == f'attachment; filename="{certified.id}{FORMATS[name].suffix}"'
    assert file.headers["content-type"] == FORMATS[name].media_type
    assert len(file.content) > 1000


def test_the_client_and_the_command_line_take_the_same_file(
    port: int, client: Station, certified: Plan, tmp_path: Path
) -> None:
    out = tmp_path / "plan.csv"
    words = ["export", "plan", certified.id, "--rate", "40", "-o", str(out), "--url", f"http://127.0.0.1:{port}"]
    said = CliRunner().invoke(app, words, catch_exceptions=False).stdout
    assert said == f"{out}: {out.stat().st_size} bytes\n"
    assert out.read_bytes() == client.program(certified.id, "csv", rate=40.0)
    again = CliRunner().invoke(app, words).exception
    assert isinstance(again, UnusableInput)
    assert "is there already; give another place with --out" in str(again)


def test_what_cannot_leave_is_said(desk: Desk, certified: Plan) -> None:
    program = f"/plans/{certified.id}/program"
    refused(desk.get("/plans/moon/program"), 404, "moon")
    refused(desk.get(f"{program}?format=xls"), 422, "there is no format 'xls' of motions; known: csv")
    for rate in ("0", "-3", "nan", "inf", "1e9"):
        refused(desk.get(f"{program}?rate={rate}"), 422, "Hz is outside 1 to 10000")
    refused(desk.get(f"{program}?rate=fast"), 422, "query.rate")
    refused(desk.get(f"{program}?speed=1"), 422, "there is no parameter 'speed'")
    refused(desk.get("/executions/moon/program"), 404, "moon")
    foreign = planned(desk.station, f"foreign-{uuid4().hex}")
    refused(desk.get(f"/plans/{foreign}/program"), 422, "plan the path again for this arm")


def test_a_revoked_plan_does_not_leave(desk: Desk, certified: Plan) -> None:
    another = f"plan-{uuid4().hex}"
    desk.station.store.add_job(Job(another, "programs", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0))
    desk.station.store.finish_planning(another, replace(certified, id=another))
    assert desk.post(f"/plans/{another}/revoke", {"reason": "the table was moved"}).is_success
    refused(desk.get(f"/plans/{another}/program"), 422, "was revoked: the table was moved")
