"""A station whose recordings go to object storage: everything over REST as before, and health says what waits."""

import asyncio
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.errors import StorageUnavailable, UnusableSettings
from teachpath.io.store.store import Store
from teachpath.job_kinds import LearningKinds
from teachpath.recorder.calibrations import Calibrations
from teachpath.robot.scenes import Scenes
from tests.contract.desk import Desk, refused
from tests.contract.rows import a_job, demonstration
from tests.contract.stations import settings, station_in
from tests.object_storage import BUCKET, ObjectServer
from tests.unit.offline.damage import TASK, make_station
from tests.waiting import wait_until

URL = f"s3://{BUCKET}/lab/cell-1"


@pytest.fixture
def away(tmp_path: Path, objects: ObjectServer) -> Iterator[Desk]:
    """A station with two demonstrations that uploads to the object storage, and a client at its REST API."""
    make_station(tmp_path, 2)
    store = {"data_dir": str(tmp_path), "recordings": URL}
    with station_in(tmp_path, store=store) as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


def test_recordings_go_to_object_storage_and_are_used_from_there(away: Desk, objects: ObjectServer) -> None:
    objects.stop()
    away.station.store.spool.start()
    rows = away.get(f"/tasks/{TASK}/demonstrations").json()
    files = [away.get(f"/demonstrations/{row['id']}/recording").content for row in rows]
    wait_until(lambda: any("2 recordings (" in note for note in away.get("/health").json()["notes"]), "health says it")
    assert "teachpath_waiting_recordings 2.0" in away.send("GET", "/metrics").text
    objects.start()

    def named() -> list[str]:
        return [row["recording"] for row in away.get(f"/tasks/{TASK}/demonstrations").json()]

    wait_until(lambda: all(name.startswith(URL) for name in named()), "the rows name objects")
    assert named() == [f"{URL}/{TASK}/{row['id']}.mcap" for row in rows]
    wait_until(lambda: not any("wait" in note for note in away.get("/health").json()["notes"]), "health says no more")
    away.station.store.spool.stop()
    shutil.rmtree(away.data_dir / "recordings")
    for row, content in zip(rows, files, strict=True):
        answer = away.get(f"/demonstrations/{row['id']}/recording")
        assert answer.content == content
        assert row["id"] in answer.headers["content-disposition"]
    assert away.get(f"/demonstrations/{rows[0]['id']}/trajectory").is_success
    assert away.ended(away.post(f"/tasks/{TASK}/jobs", {"kind": "learn"}))["state"] == "succeeded"
    objects.stop()
    shutil.rmtree(away.data_dir / "cache")
    refused(away.get(f"/demonstrations/{rows[0]['id']}/recording"), 503, f"s3://{BUCKET} does not answer")


def test_a_job_on_another_machine_waits_for_what_is_not_uploaded_yet(tmp_path: Path) -> None:
    given = settings(tmp_path, store={"data_dir": str(tmp_path), "recordings": URL})
    store = Store(given.store)
    store.ensure_task("t", scene="paper", calibration="identity")
    store.add_demonstration(demonstration("d"))
    scenes = Scenes(store.scenes, given.scenes)
    calibrations = Calibrations(
        store, given.recording, given.calibrations, scenes.get, lambda work, *values: work(*values)
    )
    kinds = LearningKinds(store, given, calibrations, scenes, is_away=True)
    with pytest.raises(StorageUnavailable, match="1 recordings wait at their station to be uploaded to s3://"):
        kinds.by_name()["learn"].prepare(a_job())
    store.change_demonstration("d", recording=f"{URL}/t/d.mcap")
    kinds.by_name()["learn"].prepare(a_job())
    store.close()


def test_a_setting_that_names_no_bucket_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnusableSettings, match=r"setting store\.recordings is 'bucket'; it should be s3://BUCKET"):
        settings(tmp_path, store={"recordings": "bucket"})
