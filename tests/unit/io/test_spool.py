"""Recordings go to object storage and come back, whatever fails on the way; none is lost, none is lost sight of."""

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from teachpath.errors import NotFound, StorageFull, StorageUnavailable, UnusableSettings
from teachpath.io.store.object_cache import ObjectCache
from teachpath.io.store.object_storage import ObjectStorage, check_url
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.spool import LINGER, LONGEST_PAUSE, Spool
from teachpath.io.store.store import Store
from teachpath.records import Demonstration
from tests.object_storage import BUCKET, ObjectServer
from tests.unit.offline.damage import TASK, file_of, flip, make_station
from tests.waiting import HANG

URL = f"s3://{BUCKET}/cell-1"


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("template")
    make_station(folder, 3)
    return folder


@pytest.fixture
def data(template: Path, tmp_path: Path) -> Path:
    """A data folder with three demonstrations."""
    return shutil.copytree(template, tmp_path / "data")


def test_a_spool_may_be_killed_at_any_moment(objects: ObjectServer, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.unit.io.spool_kills", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=False)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["wrong"] == {}
    assert said["killed"] > 10
    assert len(objects.objects) == said["killed"] + 1  # each trial has a prefix of its own


class Shown:
    """A store with object storage, whose spool works when it is told to, by a clock that is told."""

    def __init__(self, data: Path) -> None:
        self.store, self.now = Store(StoreSettings(str(data), recordings=URL)), 0.0
        store = self.store
        self.spool = Spool(
            store.recordings, store.checks.places, store.demonstration, store.change_demonstration, lambda: self.now
        )

    def work(self, seconds: float = 0.0) -> None:
        self.now += seconds
        self.spool.work()

    @property
    def rows(self) -> list[Demonstration]:
        return self.store.demonstrations(TASK)

    def is_readable(self) -> bool:
        """Whether every sample of every row can be read, and is what was recorded."""
        read = self.store.recordings.samples
        return all(len(read(row.recording, row.digest)) == row.samples for row in self.rows)


@contextmanager
def shown(data: Path) -> Iterator[Shown]:
    opened = Shown(data)
    try:
        yield opened
    finally:
        opened.store.close()


def test_what_was_recorded_is_uploaded_named_read_and_removed(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        recorded = {f"cell-1/{row.recording}": file_of(data, row).read_bytes() for row in here.rows}
        old = here.rows
        here.work()
        assert objects.objects == recorded
        assert [row.recording for row in here.rows] == [f"{URL}/{TASK}/demo-{n}.mcap" for n in (1, 2, 3)]
        assert len(here.store.recordings.finished()) == 3  # somebody may just read them
        here.work(LINGER)
        here.work(LINGER)
        assert here.store.recordings.finished() == []
        assert here.is_readable()
        for row in old:  # as somebody has them who read the rows before
            assert len(here.store.recordings.samples(row.recording, row.digest)) == row.samples
        assert (here.spool.faults(), here.spool.waiting()) == ([], (0, 0))


def test_without_object_storage_nothing_moves(data: Path) -> None:
    with shown(data) as here:
        store = Store(StoreSettings(str(data)))
        store.spool.start()
        assert store.spool.waiting() == (0, 0)
        store.close()
        assert [row.recording for row in here.rows] == [f"{TASK}/demo-{n}.mcap" for n in (1, 2, 3)]


@pytest.mark.parametrize(
    ("variable", "value", "said"),
    [
        ("AWS_ACCESS_KEY_ID", "somebody", r"is refused \(InvalidAccessKeyId\); look at AWS_ACCESS_KEY_ID"),
        ("AWS_SECRET_ACCESS_KEY", "guessed", r"is refused \(SignatureDoesNotMatch\)"),
        ("AWS_ENDPOINT_URL", "http://127.0.0.1:9", "does not answer .* is AWS_ENDPOINT_URL right"),
    ],
)
def test_what_cannot_be_uploaded_waits_and_says_why(
    data: Path, objects: ObjectServer, monkeypatch: pytest.MonkeyPatch, variable: str, value: str, said: str
) -> None:
    monkeypatch.setenv(variable, value)
    with shown(data) as here:
        here.work()
        (fault,) = here.spool.faults()
        assert fault.startswith("3 recordings (0.1 MB) wait here, and are uploaded by themselves: ")
        with pytest.raises(StorageUnavailable, match=said):
            here.store.recordings.objects.read(f"{URL}/x")
        assert objects.objects == {}
        assert here.is_readable()


def test_an_outage_is_outlasted(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        objects.stop()
        here.work()
        asked, pauses = here.spool.faults(), 0
        while here.spool._resume - here.now < LONGEST_PAUSE:
            here.work(here.spool._resume - here.now)
            pauses += 1
            assert pauses < 20
        assert "wait here" in asked[0]
        objects.start()
        here.work()  # too early
        assert objects.objects == {}
        here.work(LONGEST_PAUSE)
        assert (len(objects.objects), here.spool.faults()) == (3, [])


def test_a_full_bucket_takes_what_it_has_room_for_and_the_rest_later(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        sizes = [file_of(data, row).stat().st_size for row in here.rows]
        objects.capacity = sizes[0] + 1
        here.work()
        assert [row.recording.startswith(URL) for row in here.rows] == [True, False, False]
        assert here.spool.waiting() == (2, sum(sizes[1:]))
        assert f"s3://{BUCKET} has no room (XMinioStorageFull)" in here.spool.faults()[0]
        with pytest.raises(StorageFull):
            here.store.recordings.objects.put_new(f"{URL}/x", bytes(1 << 20), lambda: False)
        objects.capacity = 1 << 30
        here.work(LONGEST_PAUSE)
        assert all(row.recording.startswith(URL) for row in here.rows)


def test_an_upload_over_a_slow_line_can_be_given_up(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        objects.pause = 1.0
        sent = iter([False, False, True])
        with pytest.raises(StorageUnavailable, match="given up"):
            here.store.recordings.objects.put_new(f"{URL}/x", bytes(100_000), lambda: next(sent))
        objects.pause = 0.001
        here.work()
        assert len(objects.objects) == 3


def test_a_recording_that_was_changed_is_not_uploaded(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        flip(file_of(data, here.rows[1]), 200)
        objects.objects[f"cell-1/{TASK}/demo-3.mcap"] = b"of another station"
        here.work()
        assert sorted(objects.objects) == [f"cell-1/{TASK}/demo-1.mcap", f"cell-1/{TASK}/demo-3.mcap"]
        first, second = here.spool.faults()
        assert first.startswith(f"{TASK}/demo-2.mcap is not uploaded: it is not what was recorded; stop the service")
        assert "another object lies at s3://" in second
        here.work(LINGER)
        here.work(LINGER)
        assert len(here.store.recordings.finished()) == 2  # neither is removed


def test_recordings_without_a_row_stay(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        file = file_of(data, here.rows[0])
        file.with_name("demo-99.mcap").write_bytes(file.read_bytes())
        here.work()
        assert f"cell-1/{TASK}/demo-99.mcap" not in objects.objects
        assert here.spool.waiting()[0] == 1


# reading


def test_a_damaged_copy_is_fetched_again(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        here.work()
        row = here.rows[0]
        copy = here.store.recordings.path(row.recording)
        flip(copy, 200)
        assert len(here.store.recordings.samples(row.recording, row.digest)) == row.samples
        del objects.objects[f"cell-1/{TASK}/demo-1.mcap"]
        assert here.is_readable()  # from the copies
        copy.unlink()
        with pytest.raises(NotFound, match="there is no object s3://"):
            here.store.recordings.samples(row.recording, row.digest)


def test_copies_keep_their_limit_and_the_newest_one(tmp_path: Path, objects: ObjectServer) -> None:
    for number in range(4):
        objects.objects[f"x/{number}"] = bytes(100)
    cache = ObjectCache(tmp_path / "cache", 250, ObjectStorage())
    files = [cache.file(f"s3://{BUCKET}/x/{number}") for number in (0, 1, 0, 2)]
    assert [file.exists() for file in files] == [True, False, True, True]  # 0 was used again
    tight = ObjectCache(tmp_path / "cache", 10, ObjectStorage())
    assert tight.file(f"s3://{BUCKET}/x/3").exists()
    assert len(list((tmp_path / "cache").iterdir())) == 1


def test_what_is_not_uploaded_yet_is_waited_for_elsewhere(data: Path, tmp_path: Path, objects: ObjectServer) -> None:
    with shown(data) as here, shown(tmp_path / "worker") as worker:
        places = [row.recording for row in here.rows]
        here.store.recordings.require_uploaded(places)  # they are here
        with pytest.raises(StorageUnavailable, match="3 recordings wait at their station to be uploaded"):
            worker.store.recordings.require_uploaded(places)
        here.work()
        worker.store.recordings.require_uploaded([row.recording for row in here.rows])


@pytest.mark.parametrize(
    "url", ["recordings", "s3://", "s3://A_b", "s3://bucket/../x", "http://host/bucket", "s3://b b"]
)
def test_what_is_no_bucket_is_refused(url: str) -> None:
    with pytest.raises(UnusableSettings, match=r"store\.recordings is .* it should be s3://BUCKET"):
        check_url(url)
    check_url("s3://bucket/a/b_c")


def test_the_address_of_a_row_is_what_others_read(data: Path, objects: ObjectServer) -> None:
    with shown(data) as here:
        here.work()
        elsewhere = here.rows[0]
        plain = Store(StoreSettings(str(data.parent / "other")))  # names no object storage of its own
        assert len(plain.recordings.samples(elsewhere.recording, elsewhere.digest)) == elsewhere.samples
        plain.close()
